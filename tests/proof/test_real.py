"""The proof on real machines: effects that are exact on a recording, switched causes, their scores, sealed."""

import math
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_proof import STUB

from harness.app.prove.blind_worker import diagnosed
from harness.app.prove.prove import ProveOptions, prove
from harness.app.prove.verify import verify_proof
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.proof.paths.files import packed
from harness.proof.plan import Sizes
from harness.proof.real.made import (
    CONSTRUCTED,
    EFFECTS,
    REPEATED,
    SWITCHED,
    UNTOUCHED,
    Measured,
    Rig,
    effects_of,
    wanted,
)
from harness.proof.real.score import LISTED, RIGHT, SILENT, WRONG, Difference, difference, found, not_run, outcome
from harness.proof.statistics import Rate

LIST = """
[[machine]]
name = "block"
file = "dry.csv"
machine = "block"
options = { restoring = "spring" }
condition = 0.0
moves = "f_k"

[[machine]]
name = "block, pressed on"
file = "pressed.csv"
machine = "block"
options = { restoring = "spring" }
condition = 1.0
moves = "f_k"

[[machine]]
name = "axis"
file = "axis.csv"
options = { restoring = "none" }

[[machine]]
name = "another axis"
file = "lost.csv"
"""


def decay(x_k: float, number: int = 1) -> Measured:
    """A slider let go from 0.1 m at 10 rad/s, zeta 0.01, dry friction over stiffness x_k (m): half-cycles in turn."""
    zeta, omega = 0.01, 10.0
    t = 0.0125 * np.arange(260.0)
    half, q = math.pi / omega, math.exp(-zeta * math.pi)
    height, x = 0.1, np.empty(t.size)
    for turn in range(int(t[-1] / half) + 1):
        here = (t >= turn * half) & (t < (turn + 1) * half)
        side, s = (-1.0) ** turn, omega * (t[here] - turn * half)
        wave = np.exp(-zeta * s) * (np.cos(s) + zeta * np.sin(s))
        x[here] = side * (x_k + (height - x_k) * wave)
        height = max(q * height - (1.0 + q) * x_k, 0.0)
    return Measured(t, {"x": x + 1e-5 * np.random.default_rng(number).standard_normal(t.size)}, {}, False)


def run_down(f_k: float, number: int) -> Measured:
    """A wheel from 3 rad/s, viscous damping 0.4 1/s and dry friction f_k (rad/s^2), until it rests."""
    t = 0.01 * np.arange(300.0)
    v = np.maximum((3.0 + f_k / 0.4) * np.exp(-0.4 * t) - f_k / 0.4, 0.0)
    v += 1e-3 * np.random.default_rng(number).standard_normal(t.size)
    return Measured(t, {"v": v}, {}, True)


def axis() -> Measured:
    """2 kg along two sines with viscous and dry friction, encoder and force noisy, sampled irregularly."""
    rng = np.random.default_rng(2)
    t = np.cumsum(0.005 * rng.uniform(0.8, 1.2, 1500))
    x, v, a = true_axis(t).T
    u = 2.0 * a + 3.0 * v + 0.5 * np.sign(v) + 0.1 * rng.standard_normal(t.size)
    return Measured(t, {"x": x + 1e-5 * rng.standard_normal(t.size), "u": u}, {}, False, {"restoring": "none"})


def true_axis(t: FloatArray) -> FloatArray:
    return np.column_stack([
        0.1 * np.sin(3.0 * t) + 0.03 * np.sin(7.1 * t),
        0.3 * np.cos(3.0 * t) + 0.213 * np.cos(7.1 * t),
        -0.9 * np.sin(3.0 * t) - 1.5123 * np.sin(7.1 * t),
    ])  # fmt: skip


def test_speed_is_smoothed_to_a_hundredth_on_irregular_samples() -> None:
    one = axis()
    inner = slice(60, -60)
    off = (one.smoothed() - true_axis(one.t))[inner]
    assert np.std(off[:, 1]) < 0.01 * np.std(true_axis(one.t)[:, 1])


@pytest.mark.parametrize("name", [name for name in EFFECTS if name in effects_of(axis().rig("a", "a"))])
def test_a_force_beside_is_as_large_as_is_said_and_has_no_jump_where_the_axis_turns(name: str) -> None:
    one, effect = axis(), EFFECTS[name]
    put = effect.put(one, np.random.default_rng(3))
    g = put.recording.channels["u"] - one.channels["u"]
    _, v, a = true_axis(one.t).T
    base = np.column_stack([np.ones_like(v), v, a, np.sign(v)])
    beyond = g if effect.moves else g - base @ np.linalg.lstsq(base, g, rcond=None)[0]
    assert np.std(beyond) == pytest.approx(0.1 * put.amount, rel=0.25)
    turns = np.flatnonzero(np.diff(np.signbit(v)))
    step = np.abs(np.diff(g))
    assert np.max(step[turns]) < 0.2 * np.ptp(g)
    assert np.array_equal(put.recording.channels["x"], one.channels["x"])
    assert put.r2 is not None
    assert 0.97 < put.r2 < 1.0


def test_a_fast_clock_and_a_gain_keep_all_but_what_they_are_said_to_move() -> None:
    one, rng = decay(0.001), np.random.default_rng(4)
    fast = EFFECTS["a clock that runs fast"].put(one, rng)
    assert (fast.recording.t[-1] - one.t[0]) == pytest.approx((1.0 + fast.amount) * (one.t[-1] - one.t[0]))
    assert fast.recording.channels is not one.channels
    gained = EFFECTS["gain of the sensor"].put(one, rng)
    assert gained.recording.channels["x"] == pytest.approx((1.0 + gained.amount) * one.channels["x"])
    curved = EFFECTS["x + q x^2"].put(one, rng).recording.channels["x"] - one.channels["x"]
    assert np.all(curved >= -1e-12) or np.all(curved <= 1e-12)
    turning = replace(one, angular=True)
    assert "gain of the sensor" not in effects_of(turning.rig("a", "a"))
    assert "drag" not in effects_of(turning.rig("a", "a"))


def test_every_file_every_two_conditions_and_every_condition_in_halves() -> None:
    rigs = [Rig(f"{m}{c}{i}.csv", "", m, "x", float(c), "f_k") for m in "ab" for c in range(3) for i in range(2)]
    rigs.append(Rig("only.csv", "", "c", "vu"))
    jobs = wanted(rigs, 20, np.random.default_rng(1))
    by = {group: [job for job in jobs if job.group == group] for group in (UNTOUCHED, CONSTRUCTED, SWITCHED, REPEATED)}
    assert [len(of) for of in by.values()] == [13, 20, 6, 6]
    # machines take turns
    assert Counter(job.files[1][0][0] for job in by[CONSTRUCTED]) == {"a": 10, "b": 10}


def said(*names: str, grade: str = "main", omega: float = 10.0, x_k: float = 0.001) -> dict[str, Any]:
    numbers = {"omega_n": {"value": omega, "stderr": 0.01}, "x_k": {"value": x_k, "stderr": 1e-5}}
    verdict = {"main": "main_effect", "one-of": "one_of"}[grade] if names else "adequate"
    found = [{"name": name, "grade": grade, "parameters": {"q": {"value": 1.0, "stderr": 0.1}}} for name in names]
    return {"verdict": verdict, "mechanisms": found, "refined": {"parameters": numbers}}


CURVED = {"group": CONSTRUCTED, "right": ["sensor-curvature"], "moves": {}}
CLOCK = {"group": CONSTRUCTED, "right": [], "moves": {"omega_n": -1}}
LATE = {"group": CONSTRUCTED, "right": [], "moves": {}}


@pytest.mark.parametrize(
    ("truth", "before", "after", "what"),
    [
        (CURVED, said(), said("sensor-curvature"), RIGHT),
        (CURVED, said("quadratic-drag"), said("quadratic-drag", "sensor-curvature"), RIGHT),
        (CURVED, said("quadratic-drag"), said("quadratic-drag"), SILENT),
        (CURVED, said("quadratic-drag"), said("cubic-stiffness"), WRONG),
        (CURVED, said(), said("sensor-curvature", "backlash", grade="one-of"), LISTED),
        (CURVED, said(), said("backlash", grade="one-of"), WRONG),
        (CLOCK, said(), said(omega=9.9), RIGHT),
        (CLOCK, said(), said(omega=9.99), SILENT),
        (CLOCK, said(), said(omega=10.1), SILENT),
        (CLOCK, said(), said(omega=9.9, x_k=0.0011), WRONG),
        (CLOCK, said(), said("backlash", omega=9.9), WRONG),
        (LATE, said("quadratic-drag"), said("quadratic-drag"), SILENT),
        (LATE, said(), said(omega=9.9), WRONG),
    ],
)
def test_what_is_scored_is_the_difference(
    truth: dict[str, Any], before: dict[str, Any], after: dict[str, Any], what: str
) -> None:
    assert outcome(truth, Difference.of_two(before, after)) == what


def changed(*names: str, f_k: float = 1.0, c: float = 1.0) -> dict[str, Any]:
    ratios = {"f_k": f_k, "c": c}
    numbers = [
        {"name": n, "ratio": {"value": r, "stderr": 0.02}, "changed": n in names, "before": None, "after": None}
        for n, r in ratios.items()
    ]
    return {"changed": list(names), "numbers": numbers}


@pytest.mark.parametrize(
    ("result", "what"),
    [
        (changed("f_k", f_k=1.5), RIGHT),
        (changed("f_k", f_k=0.5), WRONG),
        (changed("c", c=1.5), WRONG),
        (changed("f_k", "c", f_k=1.5, c=1.5), WRONG),
        (changed("f_k", f_k=1.5, c=1.05), SILENT),
        (changed(f_k=1.5), SILENT),
    ],
)
def test_the_cause_comes_first_in_its_direction_and_the_rest_stays(result: dict[str, Any], what: str) -> None:
    truth = {"group": SWITCHED, "right": [], "moves": {"f_k": 1}}
    assert outcome(truth, Difference.of_conditions(result)) == what


def test_an_interval_over_machines_is_no_narrower_than_that_of_unlike_cases() -> None:
    assert Rate.over({"a": [True] * 8, "b": [False] * 8}).low == 0.0
    none = Rate.over({"a": [False] * 8, "b": [False] * 8})
    assert none.high == Rate.of([False] * 16).high
    assert Rate.over({}).value is None


def test_a_switch_is_told_blind_by_files_without_their_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    files = {f"{i}.csv": run_down(f_k, i).text for i, f_k in enumerate((0.5, 0.5, 0.7, 0.7))}
    result = diagnosed(packed(files), ["--restoring", "none", "--before", "0.csv,1.csv", "--after", "2.csv,3.csv"])
    assert result["changed"] == ["f_k"]
    truth = {"group": SWITCHED, "right": [], "moves": {"f_k": 1}}
    assert outcome(truth, difference(truth, {"one": truth}, {"one": result}, "one")) == RIGHT


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    place = tmp_path / "rigs"
    place.mkdir()
    for name, one in (("dry", decay(0.0005)), ("pressed", decay(0.002)), ("axis", axis())):
        (place / f"{name}.csv").write_text(one.text, encoding="utf-8")
    (place / "machines.toml").write_text(LIST, encoding="utf-8")
    return place


def test_a_proof_on_real_machines_is_sealed_and_verified_where_their_files_are(
    folder: Path, tmp_path: Path, one_version: None
) -> None:
    options = ProveOptions(Sizes(0, 0, 0, 0, real=6), jobs=1, baselines=(), blind=STUB, folder=folder)
    result = prove(options, tmp_path / "real")
    assert "lost.csv" in result.absent
    assert result.real is not None
    assert [one.machine for one in result.real.machines] == ["axis", "block"]
    assert result.real.not_run == ["repeats: not run, no machine recorded twice in one condition"]
    assert {case.group for case in result.cases} == {UNTOUCHED, CONSTRUCTED, SWITCHED}
    # the stub says of everything that nothing is left out, and nothing of conditions
    figures = {figure.key: figure for figure in result.figures}
    assert (figures["real_switched"].hits, figures["real_switched"].met) == (0, False)
    assert figures["real_told"].hits == 0
    check = verify_proof(tmp_path / "real", jobs=1, source=folder)
    assert (check.wrong, check.identical) == ([], len(result.cases))
    without = verify_proof(tmp_path / "real", jobs=1)
    assert (without.wrong, without.drawn_again) == ([], 0)
    assert "were not made again" in without.notes[0]
    assert "Machine by machine" in (tmp_path / "real" / "report.html").read_text(encoding="utf-8")
    (folder / "axis.csv").write_text(decay(0.001).text, encoding="utf-8")
    from harness.app.prove.store import measured_in

    measured_in.cache_clear()
    with pytest.raises(InputError, match=r"axis\.csv is not there, or not as it was sealed"):
        verify_proof(tmp_path / "real", jobs=1, source=folder)


def test_what_cannot_be_asked_is_said_and_is_no_figure() -> None:
    truth = {**CLOCK, "machine": "a", "files": [[], ["a.csv"]], "effect": "a clock that runs fast"}
    untouched = {**LATE, "group": UNTOUCHED, "machine": "a", "files": [[], ["a.csv"]]}
    truths = {"one": truth, "two": untouched}
    rows = {row.key: row for row in found(truths, {"one": said(omega=9.9), "two": said()})}
    assert rows.keys() == {"real_moved", "real_wrong"}
    assert (rows["real_moved"].found.value, rows["real_wrong"].found.value) == (1.0, 0.0)
    assert [line.partition(":")[0] for line in not_run(truths)] == ["switched causes", "repeats"]
