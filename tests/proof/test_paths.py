"""The proof on every way that gives a verdict: its plant, its effects, its files, its scores, sealed as any other."""

import math
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_proof import STUB

from harness.app.prove.prove import ProveOptions, prove
from harness.app.prove.verify import verify_proof
from harness.io.recording import read_recording
from harness.proof.paths import plant
from harness.proof.paths.files import numbers_in, packed, unpacked, written
from harness.proof.paths.forms import FORMS, PATHS, SHAPES, numbers, unknown
from harness.proof.paths.made import CONTROL, FORM, UNKNOWN, forms_of, made
from harness.proof.paths.rigs import BARE, NONE, draw_rig, followed, laws_of, loss, shown, unseen
from harness.proof.paths.score import outcome
from harness.proof.plan import PATHS as FULL
from harness.proof.plan import SHORT_PATHS, Sizes, plan

SEED = 2**101 + 7


def test_every_way_occurs_as_often_as_any_other_and_half_are_controls() -> None:
    jobs = plan(FULL, SEED)
    assert jobs == plan(FULL, SEED) != plan(FULL, SEED + 1)
    each = Counter((job.setting, job.group) for job in jobs)
    for path in PATHS:
        assert each[path, CONTROL] == 300
        assert each[path, FORM] >= 100
        assert {"".join(j.kinds) for j in jobs if (j.setting, j.group) == (path, FORM)} == set(forms_of(path))
    assert sum(count for (_, group), count in each.items() if group == UNKNOWN) >= 300
    assert FULL.is_evidence
    assert not SHORT_PATHS.is_evidence


def test_a_slider_of_the_plant_turns_where_the_closed_form_says() -> None:
    m, zeta, omega, x_k = 1.0, 0.02, 10.0, 0.001
    b = np.array([m, 2.0 * zeta * omega, omega**2, x_k * omega**2, 0.0])
    dt = 2.0 * math.pi / omega / 200
    x = plant.given_force(np.zeros(2000), True, dt, 4, 0.1, 0.0, b, BARE, NONE)[:, 0]
    q, height = math.exp(-math.pi * zeta / math.sqrt(1.0 - zeta**2)), 0.1
    half = math.pi / omega / math.sqrt(1.0 - zeta**2) / dt
    for turn in range(1, 12):
        height = max(q * height - (1.0 + q) * x_k, 0.0)
        near = round(turn * half)
        assert np.max(np.abs(x[near - 3 : near + 4])) == pytest.approx(height, abs=2e-5)


def test_what_is_let_go_is_accelerated_at_once() -> None:
    rig = draw_rig("free decay", np.random.default_rng(1))
    run = rig.run(BARE)
    x0 = rig.start[0]
    assert run[0, 2] == pytest.approx(-rig.b[2] * x0 + math.copysign(rig.b[3], x0))


def test_the_force_that_is_measured_is_the_one_that_moves_it() -> None:
    rig = draw_rig("slow axis", np.random.default_rng(3))
    x, v, _, u, work = rig.run(BARE).T
    m, c = rig.b[:2]
    dx = np.diff(x)
    # by the trapezium rule, which misses what bends at reversals
    wet = np.cumsum(c * 0.5 * (v[1:] + v[:-1]) * dx)
    done = np.cumsum(0.5 * (u[1:] + u[:-1]) * dx) - wet
    lost = work[1:] + 0.5 * m * v[1:] ** 2
    assert np.max(np.abs(done - lost)) < 5e-4 * wet[-1]


def test_work_against_friction_is_the_energy_that_is_lost() -> None:
    b = np.array([2.0, 0.0, 50.0, 0.3, 0.0])
    for name in ("Stribeck, exponential", "load on a bearing", "friction along the way"):
        rig = draw_rig("free decay", np.random.default_rng(1))
        scales = rig.scales(rig.run(BARE))
        p = numbers(FORMS[name].numbers(scales, np.random.default_rng(2)), scales)
        p[plant.STRIBECK] = min(p[plant.STRIBECK], 0.1)
        run = plant.given_force(np.zeros(400), True, 0.01, 8, 0.2, 0.0, b, p, NONE)
        energy = 0.5 * b[0] * run[:, 1] ** 2 + 0.5 * b[2] * run[:, 0] ** 2
        assert energy[0] - energy == pytest.approx(run[:, 4], abs=1e-5 * energy[0])


@pytest.mark.parametrize("path", PATHS)
def test_an_effect_is_as_strong_as_was_drawn_and_a_control_has_none(path: str) -> None:
    form = forms_of(path)[0]
    one = made(SEED, 3, path, FORM, form)
    assert [name.split(": ")[-1] for name in one.answer["right"]] == list(FORMS[form].right)
    assert 0.1 < one.answer["loss"] < 1e5
    bare = made(SEED, 3, path, CONTROL, "")
    assert (bare.answer["right"], bare.answer["loss"]) == ([], 0.0)
    files = unpacked(bare.recording)
    assert files is not None
    recordings = [name for name in files if name not in bare.answer["arguments"]]
    assert len(recordings) == 1 or path == "several together"


def test_no_noise_hides_nothing_of_the_base() -> None:
    rig = draw_rig("driven on a spring", np.random.default_rng(5))
    assert loss(rig, BARE) < 1e-6


@pytest.mark.parametrize("path", ["free decay", "pendulum"])
def test_what_damping_does_as_well_is_worth_nothing(path: str) -> None:
    """A force in proportion to the speed is the base's own, however strong it is and wherever the fit begins."""
    straight = np.zeros((3, plant.TABLE))
    straight[1] = np.linspace(-2.0, 2.0, plant.TABLE)
    for seed in range(3):
        rig = draw_rig(path, np.random.default_rng(seed))
        scales = rig.scales(rig.run(BARE))
        strength = 0.1 * max(scales.c * scales.fast, 0.3 * scales.f_k)
        more = numbers(
            {plant.UNKNOWN: strength, plant.UNKNOWN_FORM: 1.0, plant.UNKNOWN_V: scales.fast, plant.UNKNOWN_X: 1.0},
            scales,
        )
        assert loss(rig, more, straight) < 0.1


def test_what_acts_in_ticks_that_no_sample_shows_is_unseen() -> None:
    chatter = np.random.default_rng(3).standard_normal(40_001)
    assert unseen(chatter, 1) < 1e-12
    # of a mean of four ticks three are not logged
    assert unseen(chatter, 4) == pytest.approx(math.sqrt(3.0) / 4.0, rel=0.02)
    slow = np.sin(2.0 * math.pi * 1e-3 * np.arange(40_001.0))
    assert unseen(slow, 4) < 1e-4


@pytest.mark.parametrize(("x", "u"), [(1e-5, 0.3), (1e-3, 0.3), (1e-3, 1e-3)])
def test_an_effect_is_worth_what_noise_of_position_and_force_leave_of_it(x: float, u: float) -> None:
    n, dt, m, turn = 4000, 0.002, 2.0, 2.0 * math.pi * 9.0
    t = dt * np.arange(float(n))
    extra = 0.1 * np.sin(turn * t)
    # a position's noise in the second difference of a wave
    bent = m * x * (2.0 * math.sin(0.5 * turn * dt) / dt) ** 2
    worth = 0.5 * n * 0.5 * 0.1**2 / (u**2 + bent**2)
    assert followed(extra, np.ones(n), [np.ones(n)], dt, m, x, u) == pytest.approx(worth, rel=0.05)


def test_an_unknown_effect_that_is_all_but_a_law_is_that_law() -> None:
    rig = draw_rig("free decay", np.random.default_rng(8))
    scales = rig.scales(rig.run(BARE))
    p, tables = unknown("f(x)", scales, np.random.default_rng(1))
    grid = np.linspace(-2.0, 2.0, plant.TABLE)
    tables[0] = grid**3
    found = laws_of(rig, p, tables)
    assert found["cubic-stiffness"] > 0.99
    assert found["quadratic-stiffness"] < 0.5
    for shape in SHAPES:
        p, tables = unknown(shape, scales, np.random.default_rng(1))
        assert np.ptp(rig.run(p, tables)[:, 0] - rig.run(BARE)[:, 0]) > 0.0


def test_a_late_sensor_is_late_by_its_delay_whatever_its_order() -> None:
    rig = draw_rig("free decay", np.random.default_rng(8), both=True)
    run = rig.run(BARE)
    late = 0.05 / math.sqrt(rig.b[2])
    for order in (0.0, 1.0, 2.0):
        p = BARE.copy()
        p[plant.LATE], p[plant.LATE_FORM] = late, order
        x, t = shown(rig, run, p)["x"], np.arange(len(run)) * rig.dt
        moved = np.interp(t - late, t, run[:, 0])
        assert np.max(np.abs(x - moved)[50:]) < 0.02 * np.max(np.abs(run[:, 0]))


@pytest.mark.parametrize("turning", [False, True])
def test_files_of_loggers_are_read_as_what_was_written(turning: bool, tmp_path: Path) -> None:
    t = 0.01 * np.arange(200.0)
    x, u = 0.1 * np.exp(-t) * np.cos(20.0 * t), np.sin(7.0 * t)
    for number in range(8):
        text = written(np.random.default_rng(number), t, {"x": x, "u": u}, turning)
        (tmp_path / "recording.csv").write_text(text, encoding="utf-8")
        found = read_recording(tmp_path / "recording.csv")
        assert found.t == pytest.approx(t, abs=1e-6)
        assert found["x"] == pytest.approx(x, abs=1e-6)
        assert found["u"] == pytest.approx(u, abs=1e-6)
        assert unpacked(packed({"a.csv": text, "b.csv": text})) == {"a.csv": text, "b.csv": text}
    assert unpacked(b"t,x\n0,1\n") is None
    assert (numbers_in("1,5;2"), numbers_in("1,5,2"), numbers_in("Time (s),x")) == ([1.5, 2.0], [1.0, 5.0, 2.0], [])


@pytest.mark.parametrize(
    ("verdict", "names", "grade", "hidden", "said"),
    [
        ("adequate", [], "", [], "silent"),
        ("missing_physics", ["stribeck"], "explains", ["stribeck", "static-friction"], "named"),
        ("missing_physics", ["stribeck", "impulse"], "explains", ["stribeck"], "wrong"),
        ("one_of", ["impulse", "stribeck"], "one-of", ["stribeck"], "listed"),
        ("one_of", ["impulse", "backlash"], "one-of", ["stribeck"], "wrong"),
        ("one_of", ["impulse", "backlash", "presliding", "stribeck"], "one-of", ["stribeck"], "silent"),
        ("main_effect", ["impulse"], "main", [], "wrong"),
        ("unexplained", ["impulse"], "minor", ["stribeck"], "silent"),
    ],
)
def test_right_is_the_mechanism(verdict: str, names: list[str], grade: str, hidden: list[str], said: str) -> None:
    result: dict[str, Any] = {"verdict": verdict, "mechanisms": [{"name": n, "grade": grade} for n in names]}
    assert outcome({"right": hidden}, result) == said


def test_a_proof_on_all_ways_is_sealed_and_verified(tmp_path: Path, one_version: None) -> None:
    options = ProveOptions(Sizes(0, 0, 0, 0, paths=6), jobs=1, baselines=(), blind=STUB)
    result = prove(options, tmp_path / "paths")
    assert not result.evidence
    assert result.paths is not None
    # the stub says of everything that nothing is left out
    figures = {figure.key: figure for figure in result.figures}
    assert figures["paths_alarms"].hits == 0
    assert figures["paths_told"].hits == 0
    assert sum(level.silent.hits for level in result.paths.levels) == sum(level.cases for level in result.paths.levels)
    assert {way.path for way in result.paths.ways} <= set(PATHS)
    check = verify_proof(tmp_path / "paths", jobs=1)
    assert check.wrong == []
    # of a recording that could not be drawn the transcript says so
    asked = 6 - len(result.given_up)
    assert (check.recordings, check.identical) == (asked, asked)
    page = (tmp_path / "paths" / "report.html").read_text(encoding="utf-8")
    assert "What is told of an effect" in page
    # a number that is changed in a recording is seen
    file = next((tmp_path / "paths" / "recordings").glob("*.csv"))
    file.write_text(file.read_text(encoding="utf-8").replace("1", "2"), encoding="utf-8")
    assert any("was changed" in line for line in verify_proof(tmp_path / "paths", short=True, jobs=1).wrong)
