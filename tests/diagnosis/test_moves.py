"""The kind of a motion, told before any fit: closed forms of each, under a sensor's noise."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import harness
from harness.cli.main import run
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.moves.classify import classify, without_idle_force

T = np.arange(0.0, 20.0, 0.01)
W = 2.0 * np.pi


def noisy(channel: str, y: FloatArray, share: float = 2e-3, **beside: FloatArray) -> Recording:
    random = np.random.default_rng(8)
    shown = y + share * np.ptp(y) * random.standard_normal(y.size)
    return Recording(0.01 * np.arange(0.0, y.size), {channel: shown, **beside}, "rig.csv")


def decay(t: FloatArray) -> FloatArray:
    y: FloatArray = np.exp(-0.2 * t) * np.cos(W * t)
    return y


def again(times: int) -> FloatArray:
    """Let go, left to rest, brought back by hand and held, and let go."""
    reach = 0.5 - 0.5 * np.cos(np.pi * np.arange(0.0, 1.0, 0.01))
    one = np.concatenate((reach, np.ones(130), decay(T[:1500]) * (T[:1500] < 14.0)))
    return np.concatenate([decay(T[:1500]), *[one] * (times - 1)])


def staircase(t: FloatArray) -> FloatArray:
    """A place every four seconds, reached without overshoot."""
    levels = np.array([0.0, 1.0, 0.3, 0.9, -0.4])
    at = np.minimum((t // 4.0).astype(int), 4)
    since = t - 4.0 * at
    left = (1.0 + 8.0 * since) * np.exp(-8.0 * since)
    y: FloatArray = levels[at] + (levels[np.maximum(at - 1, 0)] - levels[at]) * left
    return y


def walk() -> FloatArray:
    return np.cumsum(np.random.default_rng(3).standard_normal(2000))


def unseen(one: Recording, *spans: tuple[float, float]) -> Recording:
    """Without the samples between times, s, of a logger that lost them."""
    return one.cut(~np.any([(one.t > low) & (one.t < high) for low, high in spans], axis=0))


CASES: dict[str, Callable[[], Recording]] = {
    "free-decay": lambda: noisy("x", decay(T)),
    "several-decays": lambda: noisy("x", again(3)),
    "run-down": lambda: noisy("v", np.maximum(20.0 - 1.5 * T, 0.0)),
    "driven": lambda: noisy("x", np.cos(W * T), u=np.cos(W * T + 1.0)),
    "slow-axis": lambda: noisy("x", np.abs((T % 8.0) - 4.0)),
    "held": lambda: noisy("x", np.interp(T, [0.0, 2.0, 3.0, 20.0], [0.0, 0.0, 1.0, 1.0])),
    "steps": lambda: noisy("x", staircase(T)),
    "spin-up": lambda: noisy("v", 30.0 * (1.0 - np.exp(-T / 6.0))),
    "at-rest": lambda: noisy("a", np.random.default_rng(1).standard_normal(2000), 0.0),
    "not-mechanical": lambda: noisy("x", walk()),
}


def test_what_is_driven_along_a_road_does_not_run_down_because_it_slows_at_the_end() -> None:
    traffic = noisy("v", 5.0 + 2.0 * np.sin(1.4 * T) + 0.6 * T / T[-1])
    assert classify(traffic.cut(traffic.t < 19.0)).kind == "driven"
    pushed = np.interp(T, [0.0, 2.0, 3.0, 5.0, 20.0], [0.0, 12.0, 11.0, 20.0, 1.0])  # by hand, twice
    assert classify(noisy("v", pushed)).kind == "run-down"


def test_a_wheel_that_is_spun_up_again_and_again_runs_down_as_often() -> None:
    t = np.arange(0.0, 160.0, 0.05)
    since = t % 40.0
    fallen = np.maximum((28.0 + 30.0) * np.exp(-(since - 5.0) / 50.0) - 30.0, 0.0)  # v' = -(v + 30) / 50
    v = np.where(since < 5.0, 28.0 * since / 5.0, fallen) + 0.05 * np.random.default_rng(8).standard_normal(t.size)
    wheel = Recording(t, {"v": v}, "wheel.csv")
    found = classify(wheel)
    assert (found.kind, len(found.spans)) == ("run-down", 4)
    np.testing.assert_allclose([low % 40.0 for low, _ in found.spans], 5.0, atol=1.0)
    part, notes = found.part(wheel)
    assert part.t[-1] - part.t[0] < 40.0
    assert "4 run-downs were found" in notes[0]
    stop_and_go = 14.0 * np.clip(np.sin(2.0 * np.pi * t / 40.0), 0.0, None)
    assert classify(Recording(t, {"v": stop_and_go + v * 1e-3}, "town.csv")).kind != "run-down"


def test_a_motor_that_is_switched_goes_from_speed_to_speed() -> None:
    levels = np.array([0.0, 11.0, 4.0, 9.0])
    at = np.minimum((T // 5.0).astype(int), 3)
    switched = levels[at] + (levels[np.maximum(at - 1, 0)] - levels[at]) * np.exp(-(T % 5.0) / 0.1)
    assert classify(noisy("v", switched)).kind == "steps"


@pytest.mark.parametrize("kind", ["free-decay", "run-down", "driven"])
def test_a_load_cell_that_nothing_loads_does_not_drive_what_moves_freely(kind: str) -> None:
    moved = CASES[kind]()
    channels = {name: y for name, y in moved.channels.items() if name != "u"}
    idle = 3.0 + 0.1 * np.random.default_rng(5).standard_normal(len(moved))
    found = without_idle_force(replace(moved, channels={**channels, "u": idle}))
    assert ("u" in found) == (kind == "driven")
    assert classify(found).kind == kind
    assert ("noise about" in " ".join(found.notes)) == (kind != "driven")
    pushed = replace(moved, channels={**channels, "u": np.sin(W * moved.t)})
    assert "u" in without_idle_force(pushed)


def test_a_wheel_that_viscous_friction_alone_stops_is_no_drift_once_it_has_turned() -> None:
    """An angle that comes to a level exponentially, 20 turns on; within one turn a sensor may drift so."""
    x = 120.0 * (1.0 - np.exp(-T / 4.0)) + 1e-3 * np.random.default_rng(7).standard_normal(T.size)
    assert classify(Recording(T, {"x": x}, "wheel.csv", angular=True)).kind == "run-down"
    assert classify(Recording(T, {"x": x / 120.0}, "drift.csv", angular=True)).kind == "not-mechanical"


def test_the_force_of_its_own_spring_does_not_drive_what_swings() -> None:
    moved = CASES["free-decay"]()
    spring = 49.0 * moved["x"] + 0.01 * np.random.default_rng(6).standard_normal(len(moved))
    found = without_idle_force(replace(moved, channels={**moved.channels, "u": spring}))
    assert "u" not in found
    assert "that of its own spring" in " ".join(found.notes)
    driven = CASES["driven"]()
    held = without_idle_force(replace(driven, channels={**driven.channels, "u": 49.0 * driven["x"]}))
    assert "u" in held


@pytest.mark.parametrize("kind", CASES)
def test_a_motion_is_told_and_why(kind: str) -> None:
    found = harness.motion(CASES[kind]())
    assert found.kind == kind
    assert found.reason
    assert bool(found.wanted) == (kind in ("slow-axis", "held", "steps", "spin-up", "at-rest", "not-mechanical"))


@pytest.mark.parametrize("kind", ["slow-axis", "held", "steps", "spin-up", "at-rest", "not-mechanical"])
def test_what_tells_no_friction_is_refused_with_what_would(kind: str) -> None:
    with pytest.raises(InputError) as told:
        harness.diagnose(CASES[kind]())
    assert kind in str(told.value)
    assert harness.motion(CASES[kind]()).wanted in str(told.value)


@pytest.mark.parametrize("kind", ["free-decay", "run-down", "spin-up", "at-rest", "not-mechanical", "steps"])
def test_unit_clock_and_sign_change_no_kind(kind: str) -> None:
    one = CASES[kind]()
    other = Recording(1.7e9 + 0.3 * one.t, {c: -1e3 * y for c, y in one.channels.items()}, "rig.csv")
    assert harness.motion(other).kind == kind


def test_what_loses_little_of_its_swing_decays_and_what_keeps_it_is_driven() -> None:
    """6 % lost in six cycles, half by half; and none at all."""
    t = T[:600]
    assert classify(noisy("x", np.exp(-0.01 * t) * np.cos(W * t), 2e-4)).kind == "free-decay"
    kept = classify(noisy("x", np.cos(W * t), 2e-4))
    assert kept.kind == "driven"
    assert "or it is hardly damped" in kept.wanted


def test_a_swing_is_no_run_down_where_a_spring_is_known() -> None:
    creep = noisy("v", np.maximum(20.0 - 1.5 * T, 0.0))
    assert harness.motion(creep, restoring="spring").kind != "run-down"


def test_several_decays_are_cut_and_each_is_one() -> None:
    whole = CASES["several-decays"]()
    spans = harness.motion(whole).spans_s
    assert len(spans) == 3
    for low, high in spans:
        assert harness.motion(whole.cut((whole.t >= low) & (whole.t <= high))).kind == "free-decay"


@pytest.mark.parametrize(
    ("whole", "lost"),
    [
        # half a cycle, many, a part of one at each of three places, the ends of what a sensor overran
        (noisy("x", decay(T)), [(5.0, 5.5)]),
        (noisy("x", decay(T)), [(4.1, 9.3)]),
        (noisy("x", decay(T)), [(2.0, 2.3), (5.1, 5.6), (9.0, 9.9)]),
        (noisy("v", decay(T)), [(3.3, 4.6)]),
        (noisy("a", decay(T)), [(3.25, 3.75)]),
    ],
)
def test_a_gap_is_no_second_release(whole: Recording, lost: list[tuple[float, float]]) -> None:
    """The amplitude goes on from before it, whatever half-swings it hides; the damping is that of the whole."""
    recording = unseen(whole, *lost)
    assert harness.motion(recording).kind == "free-decay"
    baseline = harness.identify(recording).baseline
    assert baseline is not None
    zeta = baseline.parameters["zeta"]
    assert zeta.value == pytest.approx(0.2 / np.hypot(0.2, W), abs=5.0 * (zeta.stderr or 0.0))


def test_a_gap_in_which_it_was_let_go_again_parts_two_decays() -> None:
    """The second begins three times as large as the first ended; where it was held, nobody recorded."""
    whole = CASES["several-decays"]()
    first, second, third = harness.motion(whole).spans_s
    between = [(first[1] - 6.0, second[0] + 0.6), (second[1] - 6.0, third[0] + 0.6)]
    found = harness.motion(unseen(whole, *between))
    assert found.kind == "several-decays"
    for (low, high), (_, end), (begin, _) in zip(between, found.spans_s[:-1], found.spans_s[1:], strict=True):
        assert end <= low
        assert begin >= high


def test_of_several_decays_one_is_identified_and_the_others_are_told() -> None:
    found = harness.identify(CASES["several-decays"]())
    zeta = found.estimates["displacement"].zeta
    assert zeta.value == pytest.approx(0.2 / W, abs=4.0 * (zeta.stderr or 0.0))
    assert any("3 decays" in line for line in found.warnings)


def test_the_terminal_and_json_tell_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "rest.csv"
    rows = zip(T, np.random.default_rng(2).standard_normal(T.size), strict=True)
    file.write_text("t,x\n" + "".join(f"{t:.3f},{x:.5f}\n" for t, x in rows))
    assert run(["log", str(file)]) == 0
    assert "at-rest" in capsys.readouterr().out
    assert run(["log", str(file), "--json", "-"]) == 0
    assert json.loads(capsys.readouterr().out)["recording"]["motion"]["kind"] == "at-rest"
    assert run(["diagnose", str(file), "--out", str(tmp_path / "out")]) == 2
    assert not (tmp_path / "out").exists()
