"""Run-downs: what is let go in motion and pulled back by nothing. Truths are closed forms of m v' = -f_k - c v."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import harness
from harness.app.diagnose.many import diagnose_together
from harness.app.diagnose.options import DiagnoseOptions
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.results.common import P

NOISE = 2e-3
"""rad."""


def told(t: FloatArray, **channels: FloatArray) -> Recording:
    """A recording of a wheel, with a sensor's noise on each channel."""
    random = np.random.default_rng(4)
    noisy = {c: y + random.normal(0.0, NOISE, y.size) for c, y in channels.items()}
    return Recording(t, noisy, file="wheel.csv", angular=True)


def coulomb(t: FloatArray, v0: float, f: float) -> tuple[FloatArray, FloatArray]:
    """Angle and speed under dry friction f alone: a straight line down, then rest."""
    s = np.minimum(t, v0 / f)
    return v0 * s - 0.5 * f * s**2, v0 - f * s


def viscous(t: FloatArray, v0: float, c: float, f: float) -> tuple[FloatArray, FloatArray]:
    """The same under damping c besides: an exponential towards -f/c, until it stops."""
    s = np.minimum(t, math.log1p(c * v0 / f) / c if f > 0.0 else math.inf)
    e = np.exp(-c * s)
    return (v0 + f / c) * (1.0 - e) / c - f / c * s, (v0 + f / c) * e - f / c


def holds(found: P, truth: float) -> None:
    """An estimate holds a truth within four of its standard errors."""
    assert found.value is not None
    assert found.stderr is not None
    assert abs(found.value - truth) < 4.0 * found.stderr


T = np.arange(0.0, 12.0, 0.02)


def test_a_straight_line_down_is_dry_friction_alone() -> None:
    found = harness.diagnose(told(T, x=coulomb(T, 20.0, 2.5)[0]), engines=())
    assert found.verdict == "adequate"
    holds(found.baseline.parameters["f_k"], 2.5)
    assert found.baseline.parameters["c"].value == pytest.approx(0.0, abs=1e-3)


def test_an_exponential_is_damping_alone_and_a_tachometer_is_enough() -> None:
    found = harness.diagnose(told(T, v=viscous(T, 30.0, 0.4, 0.0)[1]), engines=())
    assert found.verdict == "adequate"
    holds(found.baseline.parameters["c"], 0.4)
    assert found.baseline.parameters["f_k"].value == pytest.approx(0.0, abs=1e-2)


@pytest.mark.parametrize("draw", range(4))
def test_the_noise_of_a_tachometer_grows_with_the_speed(draw: int) -> None:
    """1 % of the speed: what is slow counts more, and friction is known to half of what an even noise allows."""
    t = np.arange(0.0, 62.0, 0.05)
    v = viscous(t, 100.0, 0.02, 0.8)[1]
    noisy = v * (1.0 + 0.01 * np.random.default_rng(draw).standard_normal(t.size))
    found = harness.diagnose(Recording(t, {"v": noisy}, file="tachometer", angular=True), engines=())
    assert found.verdict == "adequate"
    numbers = found.baseline.parameters
    holds(numbers["c"], 0.02)
    holds(numbers["f_k"], 0.8)
    assert numbers["f_k"].stderr is not None
    assert numbers["f_k"].stderr < 1.2e-3
    assert any("The noise of v grows with the speed, by 1" in line or "by 0.9" in line for line in found.warnings)


@pytest.mark.parametrize("draw", range(3))
def test_a_mark_a_turn_that_a_clock_samples_tells_friction(tmp_path: Path, draw: int) -> None:
    t = 0.01 * draw / 3.0 + np.arange(0.0, 74.0, 0.02)
    turns = np.floor(viscous(t, 25.0 + draw, 0.02, 0.15)[0] / (2.0 * np.pi))
    path = tmp_path / "wheel.csv"
    path.write_text("time_s,turns [rev]\n" + "\n".join(f"{one:.4f},{n:.0f}" for one, n in zip(t, turns, strict=True)))
    found = harness.diagnose(path, engines=())
    assert found.verdict == "adequate"
    holds(found.baseline.parameters["c"], 0.02)
    holds(found.baseline.parameters["f_k"], 0.15)


def test_forces_are_of_an_inertia_that_is_known_and_both_directions_are_one() -> None:
    x, v = viscous(T, 25.0, 0.2, 1.5)
    found = harness.diagnose(told(T, x=-x, v=-v), mass=0.03, engines=())
    assert found.verdict == "adequate"
    holds(found.baseline.parameters["c"], 0.2 * 0.03)
    holds(found.baseline.parameters["f_k"], 1.5 * 0.03)
    assert found.baseline.parameters["mass"].value == 0.03
    assert "per" not in found.baseline.parameters["f_k"].unit


def test_what_comes_before_it_and_after_it_is_left_out() -> None:
    t = np.arange(0.0, 40.0, 0.02)
    x, _ = viscous(np.maximum(t - 5.0, 0.0), 25.0, 0.2, 1.5)
    x += 25.0 * np.minimum(t - 5.0, 0.0)
    found = harness.diagnose(told(t, x=x), engines=())
    assert found.verdict == "adequate"
    holds(found.baseline.parameters["c"], 0.2)
    holds(found.baseline.parameters["f_k"], 1.5)
    assert len([line for line in found.recording.notes if "are skipped" in line]) == 2


def test_the_isolated_cases_are_identified_with_their_errors() -> None:
    line = harness.identify(told(T, x=coulomb(T, 20.0, 2.5)[0])).slowing
    holds(line["linear"].f_k, 2.5)
    assert line["linear"].chi2_per_point < 1.5
    assert line["exponential"].chi2_per_point > 100.0
    decay = harness.identify(told(T, v=-viscous(T, 30.0, 0.4, 0.0)[1])).slowing
    holds(decay["exponential"].c, 0.4)
    assert decay["exponential"].chi2_per_point < 1.5
    assert decay["linear"].chi2_per_point > 100.0


@pytest.mark.parametrize("channels", ["x", "v", "xv"])
def test_dry_and_viscous_friction_are_identified_together(channels: str) -> None:
    x, v = viscous(T, 25.0, 0.2, 1.5)
    found = harness.identify(told(T, **{c: {"x": x, "v": v}[c] for c in channels}))
    assert found.restoring == "none"
    assert found.motion is not None
    assert found.motion.kind == "run-down"
    holds(found.slowing["both"].f_k, 1.5)
    holds(found.slowing["both"].c, 0.2)
    assert found.baseline is not None
    holds(found.baseline.parameters["f_k"], 1.5)


def test_what_no_run_down_parts_is_said_and_a_part_held_out_is_predicted() -> None:
    found = harness.diagnose(told(T, x=viscous(T, 25.0, 0.2, 1.5)[0]), engines=())
    assert any("one direction" in line and "grade" in line for line in found.recording.notes)
    assert any("ratios" in line for line in found.recording.notes)
    assert set(found.baseline.parameters) == {"c", "f_k"}
    assert found.holdout.baseline_rmse["x"] < 2.0 * NOISE


def test_a_creep_that_nothing_stops_is_read_where_it_is_said_to_run_down() -> None:
    creeping = told(T, x=viscous(T, 25.0, 0.4, 0.0)[0])
    along = replace(creeping, angular=False)  # an angle that has turned round is no drift
    with pytest.raises(InputError, match="--restoring none"):
        harness.diagnose(along)
    found = harness.diagnose(creeping, restoring="none", engines=())
    holds(found.baseline.parameters["c"], 0.4)


def test_no_run_down_is_refused_where_nothing_runs_down() -> None:
    steady = told(T, x=3.0 * T)
    with pytest.raises(InputError):
        harness.diagnose(steady, restoring="none")
    with pytest.raises(InputError):
        harness.diagnose(steady)


def test_the_command_leaves_page_trace_and_models(tmp_path: Path) -> None:
    harness.diagnose(told(T, x=viscous(T, 25.0, 0.2, 1.5)[0]), out=tmp_path / "left")
    for file in ("report.html", "trace.rrd", "model/model.json"):
        assert (tmp_path / "left" / file).stat().st_size > 0


def test_two_directions_part_a_push_from_dry_friction(tmp_path: Path) -> None:
    """A car coasts up a grade and down again; its speed has no sign, so that one file is said to go the other way."""
    for name, v0, slows in (("up.csv", 20.0, 1.9), ("down.csv", 15.0, 1.1)):
        rows = np.column_stack((T, told(T, v=viscous(T, v0, 0.2, slows)[1])["v"]))
        np.savetxt(tmp_path / name, rows, delimiter=",", header="t [s],v [m/s]", comments="")
    options = DiagnoseOptions(engines=())
    files = [(tmp_path / name, name) for name in ("up.csv", "down.csv")]
    found = diagnose_together(files, options, tmp_path / "both", turned=["down.csv"])
    assert [m.name for m in found.mechanisms] == ["constant-force"]
    holds(found.mechanisms[0].parameters["force"], -0.4)
    holds(found.refined.parameters["f_k"], 1.5)
    holds(found.refined.parameters["c"], 0.2)
    assert found.together is not None
    holds(found.together["f_k"].value, 1.5)


def test_run_downs_of_one_direction_share_their_friction_and_say_what_that_holds() -> None:
    each = [told(T, v=viscous(T, v0, 0.2, 1.5)[1]) for v0 in (25.0, 12.0)]
    found = harness.diagnose(each, engines=())
    assert found.verdict == "adequate"
    holds(found.baseline.parameters["f_k"], 1.5)
    assert any("one direction" in line and "grade" in line for line in found.recording.notes)
    swing = Recording(T, {"v": np.exp(-0.1 * T) * np.cos(4.0 * T)}, file="swing.csv", angular=True)
    with pytest.raises(InputError, match=r"swing\.csv"):
        harness.diagnose([each[0], swing])


def test_which_way_it_runs_down_says_nothing_of_a_force_of_no_name() -> None:
    """Dry friction with a hump at one speed: nothing moves the other way, whichever that is."""
    t, v = T[:400:4], [12.0]
    for _ in t[1:]:
        pulled = 0.8 + 0.05 * v[-1] + 0.6 * math.exp(-(((v[-1] - 6.0) / 1.5) ** 2))
        v.append(max(v[-1] - pulled * float(t[1] - t[0]), 0.0))
    forwards = told(t, v=np.array(v))
    backwards = replace(forwards, channels={"v": -forwards["v"]})
    found, mirrored = (harness.diagnose(one, engines=()) for one in (forwards, backwards))
    assert found.verdict == mirrored.verdict
    assert [m.name for m in found.mechanisms] == [m.name for m in mirrored.mechanisms]
