"""The plant of machines: repeatable to the bit, shares that another fit finds, answers that say what is in the file."""

import json
import math
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.optimize import least_squares

from benchmarks.recordings import score as command
from benchmarks.recordings.driven import DRIVEN
from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.proof.machines.cases import SHARES, SMALL, TABLE_SHARES, Messy, _control, draw
from harness.proof.machines.kinds import CONTROL, FREE, MAIN, TABLE, UNNAMED, Job
from harness.proof.machines.made import Made, csv_text, made, truth
from harness.proof.machines.rigs import draw_rig
from harness.proof.machines.score import Claim, right, score
from harness.proof.machines.shares import read, summed_up
from harness.proof.plant.base_fit import decay_motion
from harness.proof.plant.effects import EFFECTS, FAMILY, OF_MACHINES, STATIC
from harness.proof.plant.integrate import simulate
from harness.proof.plant.stepped import swing
from harness.proof.plant.strengths import DRAWS, scaled
from harness.proof.statistics import Median, Rate

SEED = 4711
DRAWN = {
    "cart": Job(0, MAIN, FREE["cart"], "viscoelastic"),
    "arm": Job(1, MAIN, FREE["spring-arm"], "quadratic-drag"),
    "pendulum": Job(3, MAIN, FREE["encoder-pendulum"], "asymmetric-viscous"),
    "control": Job(4, CONTROL, FREE["spring-arm"], ""),
    "table": Job(6, TABLE, FREE["spring-arm"], "alien-magnet-well"),
    "unknown": Job(7, UNNAMED, FREE["servo-pendulum"], "alien-parametric-stiffness"),
    "axis": Job(8, MAIN, DRIVEN["spring-axis"], "cubic-stiffness"),
}


@cache
def job_made(name: str) -> Made:
    return made(SEED, DRAWN[name])


@cache
def case_of(name: str) -> Messy:
    job = DRAWN[name]
    return draw(job.kind, job.main, np.random.default_rng([SEED, 1, job.index, 0]))


def columns(text: str) -> tuple[list[str], FloatArray]:
    head, *rows = text.splitlines()
    return head.split(","), np.array([[float(n) for n in row.split(",")] for row in rows])


def test_every_name_can_be_built_and_drawn() -> None:
    assert set(EFFECTS) == set(DRAWS)
    assert len(FREE) >= 8
    assert {name for kind in FREE.values() for name in kind.names} >= set(OF_MACHINES) - {"static-friction"}
    assert {name for kind in DRIVEN.values() for name in kind.names} >= set(OF_MACHINES) - {"pendulum-stiffness"}
    rng, base = np.random.default_rng(0), case_of("arm").rig.base
    for name in EFFECTS:
        values = DRAWS[name](base, rng)
        assert set(scaled(name, values, 0.5, base)) == set(values)
        assert json.loads(json.dumps(values)) == values
        assert EFFECTS[name].families[0] in set(FAMILY.values())


def refitted(case: Messy, effects: Any) -> float:
    """Squares that SciPy's own fit of the base leaves of the true motion, channels by their weights."""
    rig, b = case.rig, case.rig.base
    _, clean = rig.motion(effects)
    after = rig.t >= rig.free_from + 0.12 * 2.0 * math.pi / b.omega_n
    t, motion = rig.t[after] - rig.t[after][0], decay_motion if b.restoring == "spring" else swing
    unit = np.array([b.omega_n, 0.01, 0.01 * b.length, b.length, b.speed, b.length])

    def left(z: FloatArray, n: int) -> FloatArray:
        x, v, a = motion(t[:n], *(z * unit)[:5])
        said = {"x": x + (0.0 if rig.told_zero else z[5] * unit[5]), "v": v, "a": a}
        return np.concatenate([math.sqrt(w) * (clean[c][after][:n] - said[c]) for c, w in case.weight.items()])

    z = np.array([b.omega_n, b.zeta, b.x_k, clean["x"][after][0], clean["v"][after][0], 0.0]) / unit
    for part in (0.1, 0.2, 0.3, 0.5, 0.7, 1.0):
        found = least_squares(left, z, x_scale="jac", method="trf", args=(int(part * t.size),))
        z = found.x
    return float(2.0 * found.cost)


@pytest.mark.parametrize("name", ["cart", "arm", "pendulum", "table"])
def test_shares_are_those_of_an_independent_refit(name: str) -> None:
    case = case_of(name)
    rest = {other: values for other, values in case.effects.items() if other != case.main}
    share = 1.0 - refitted(case, rest) / refitted(case, case.effects)
    low, high = TABLE_SHARES if name == "table" else SHARES
    assert case.share is not None
    assert low <= case.share <= high
    assert share == pytest.approx(case.share, abs=0.01)


def test_a_control_has_no_main_effect_and_none_above_half() -> None:
    answer = job_made("control").answer
    assert answer["dominant"] is None
    assert answer["share"] is None
    assert all(part <= SMALL for part in answer["minor"].values())
    drawn = {"sensor-gain"} if "gain" in answer["nuisances"] else set()
    assert set(answer["may_name"]) <= set(answer["minor"]) | drawn


def test_the_law_of_what_is_left_sums_it_up_and_one_of_another_kind_does_not() -> None:
    rig = case_of("arm").rig
    whole = read(rig, {"quadratic-drag": DRAWS["quadratic-drag"](rig.base, np.random.default_rng(1))})
    shares = summed_up(rig, whole, {"x": 1.0}, frozenset(), np.random.default_rng(2))
    # a form-fixed law differs from itself at another strength by second order alone
    assert shares["quadratic-drag"] > 0.95
    assert shares["quadratic-drag"] == max(shares.values())
    assert max(shares[name] for name in ("quadratic-stiffness", "harmonic-force", "impulse")) < 0.6
    assert not {"sensor-bias", "sensor-lag"} & set(shares)
    assert "quadratic-drag" not in summed_up(
        rig, whole, {"x": 1.0}, frozenset({"quadratic-drag"}), np.random.default_rng(2)
    )


def test_a_pendulum_that_is_driven_beyond_all_numbers_is_refused() -> None:
    """The sine of what is beyond them is none."""
    rig = case_of("pendulum").rig
    assert rig.base.restoring == "pendulum"
    with np.errstate(over="ignore", invalid="ignore"), pytest.raises(SimulationError, match="machines: "):
        read(rig, {"quadratic-drag": {"c2": -1e3 * rig.base.m}}, quick=True)


@pytest.mark.parametrize("name", sorted(DRAWN))
def test_the_answer_says_what_is_in_the_file(name: str) -> None:
    answer, (head, values) = job_made(name).answer, columns(job_made(name).recording)
    assert json.loads(json.dumps(answer)) == answer
    assert values.shape[0] == answer["samples"]
    assert np.all(np.diff(values[:, 0]) > 0.0)
    assert [column.split(" ")[0] for column in head] == ["t", *answer["channels"], *(["u"] if name == "axis" else [])]
    assert all(column.endswith("]") for column in head)
    told = dict(zip(answer["options"][::2], answer["options"][1::2], strict=True))
    assert told["--restoring"] in ("spring", "pendulum", "none")
    assert told.get("--zero", "free") in ("spring", "free")
    assert set(told) <= {"--restoring", "--zero"}
    assert ("table" in answer) == (answer["dominant"] in STATIC)
    if answer["dominant"]:
        assert answer["family"] in answer["families"]
        assert set(answer["plant"]) == {answer["dominant"], *answer["minor"]}


@pytest.mark.parametrize("name", ["arm", "cart", "control"])
def test_noise_steps_and_stamps_are_as_stated(name: str) -> None:
    case = case_of(name)
    rig, answer = case.rig, truth(case)
    for channel in rig.channels:
        added = case.recorded[channel] - case.whole.clean[channel] - (rig.zero if channel == "x" else 0.0)
        size = case.noise.noise.total(channel)
        correlated = 1.0 + case.noise.noise.correlation
        assert np.std(added) == pytest.approx(size, rel=8.0 * correlated / math.sqrt(added.size))
        assert answer["noise"][channel] >= size
        step = (case.noise.noise.step or {}).get(channel)
        if step:
            counts = case.recorded[channel] / step
            assert counts == pytest.approx(np.round(counts), abs=1e-6)
    late = rig.t - rig.stamps
    assert (np.std(late) > 0.0) == (rig.clock in ("jitter", "rounded"))
    assert np.max(np.abs(late)) < float(rig.t[-1]) / (rig.t.size - 1)
    assert csv_text(case).count("\n") == rig.t.size + 1


def test_a_table_holds_the_true_curve_over_the_swept_range() -> None:
    case, answer = case_of("table"), truth(case_of("table"))
    p, curve = case.effects["alien-magnet-well"], answer["table"]
    at = np.array(curve["at"])
    s = (at - p["place"]) / p["width"]
    assert curve["form"] == "f(x)"
    assert np.array(curve["force"]) == pytest.approx(p["size"] * s * np.exp(0.5 - 0.5 * s**2), rel=1e-12)
    assert at[0] >= case.whole.run.x.min() - 1e-12
    assert at[-1] <= case.whole.run.x.max() + 1e-12


def test_a_hand_holds_then_gives_way() -> None:
    case = draw(FREE["spring-arm"], "quadratic-drag", np.random.default_rng(23))
    assert case.rig.release == "gives-way"
    rig, clean = case.rig, case.whole.clean
    assert 0.005 <= rig.hand.fades <= 0.05
    held = rig.t < rig.hand.until
    assert np.all(clean["v"][held] == 0.0)
    # let go at once it would have moved by k x t^2/2; a hand that fades has let it go less far
    going = (rig.t > rig.hand.until) & (rig.t < rig.hand.until + rig.hand.fades)
    free = 0.5 * rig.base.omega_n**2 * rig.base.length * (rig.t[going] - rig.hand.until) ** 2
    assert np.all(np.abs(clean["x"][going] - rig.base.x0) <= free + 1e-12)
    assert rig.free_from == pytest.approx(rig.hand.until + rig.hand.fades)


@pytest.mark.parametrize("x_k", [0.0, 0.01])
def test_the_stepped_pendulum_is_that_of_the_plant(x_k: float) -> None:
    base = case_of("pendulum").rig.base.moved(np.array([6.0, 0.01, x_k, 1.2, 0.0]))
    t = np.linspace(0.0, 12.0, 600)
    exact = simulate(base.model(), t)
    x, v, a = swing(t, 6.0, 0.01, x_k, 1.2, 0.0)
    assert x == pytest.approx(exact.x, abs=2e-4)
    assert v == pytest.approx(exact.v, abs=2e-3)
    assert np.median(np.abs(a - exact.a)) < 5e-3


def result(verdict: str, *mechanisms: dict[str, Any], after: float = 0.5) -> dict[str, Any]:
    held = {"baseline_rmse": {"x": 1.0}, "refined_rmse": {"x": after}}
    return {"verdict": verdict, "mechanisms": list(mechanisms), "holdout": held}


def test_claims_are_read_in_both_forms() -> None:
    old = Claim.of(result("missing_physics", {"name": "stribeck", "alternatives": [{"name": "presliding"}]}))
    assert (old.main, old.near) == ("stribeck", frozenset({"stribeck", "presliding"}))
    several = Claim.of(result("one_of", *({"name": n, "grade": "one-of"} for n in ("stribeck", "presliding"))))
    assert (several.main, several.near) == ("", frozenset({"stribeck", "presliding"}))
    small = Claim.of(result("unexplained", {"name": "stribeck", "grade": "minor"}))
    assert (small.main, small.near, small.minor) == ("", frozenset(), frozenset({"stribeck"}))
    table = Claim.of(result("main_effect", {"name": "impulse", "grade": "main"}, {"name": "f", "grade": "tabulated"}))
    assert (table.main, table.minor) == ("impulse", frozenset({"f"}))
    assert Claim.of(None).main == ""


def hits(scores: Mapping[str, Rate | Median], name: str) -> int:
    rate = scores[name]
    assert isinstance(rate, Rate)
    return rate.hits


def test_figures_count_what_they_say() -> None:
    names = ("stribeck", "presliding", "impulse", "end-stop", "backlash")
    truths: dict[str, dict[str, Any]] = {
        "a": {"dominant": "stribeck", "family": "friction", "share": 0.8, "minor": {}, "kind": "cart"},
        "b": {"dominant": "impulse", "family": "environment", "share": 0.8, "minor": {}, "kind": "cart"},
        "c": {"dominant": "backlash", "family": "stiffness", "share": 0.8, "minor": {}, "kind": "cart"},
        "d": {"dominant": None, "family": None, "share": None, "minor": {"impulse": 0.4}, "may_name": ["impulse"]},
        "e": {"dominant": None, "family": None, "share": None, "minor": {}},
        "f": {"dominant": "alien-x", "family": "friction", "families": ["friction", "damping"], "share": 0.7},
        "g": {"dominant": "alien-y", "family": "friction", "share": 0.7, "group": "table"},
    }
    said = {
        "a": result("main_effect", {"name": "stribeck", "grade": "main", "share": 0.7}),
        "b": result("one_of", *({"name": n, "grade": "one-of"} for n in names[:4]), after=0.9),
        "c": result("one_of", *({"name": n, "grade": "one-of"} for n in names)),
        "d": result("main_effect", {"name": "impulse", "grade": "main"}),
        "e": result("main_effect", {"name": "impulse", "grade": "main"}),
        "f": result("main_effect", {"name": "quadratic-drag", "grade": "main"}),
        "g": result("main_effect", {"name": "impulse", "grade": "main"}, after=0.6),
    }
    scores = score(truths, said)
    counted = {name: (rate.hits, rate.cases) for name, rate in scores.items() if isinstance(rate, Rate)}
    assert counted["named"] == (1, 3)
    assert counted["listed"] == (2, 3)
    assert counted["wrong"] == (0, 3)
    assert counted["silent"] == (0, 3)
    assert counted["claimed"] == (1, 2)
    assert counted["unfounded"] == (1, 2)
    assert counted["misled"] == (1, 2)
    assert counted["better"] == (1, 2)
    assert counted["table_better"] == (1, 1)
    assert scores["share_error"].value == pytest.approx(0.1)
    assert hits(score(truths, {}), "silent") == 3
    assert any(line.startswith("named or listed: 2 of 3, 66.7 %") for line in command.lines(scores))
    assert list(command.misses(truths, said)) == [
        "b: impulse (80 %) on a cart called end-stop, impulse, presliding, stribeck (listed)",
        "c: backlash (80 %) on a cart called backlash, end-stop, impulse, presliding, stribeck",
        "e: control () called impulse",
    ]
    in_it = score({**truths, "e": {**truths["e"], "minor": {"impulse": 0.45, "backlash": 0.45}}}, said)
    assert (hits(in_it, "claimed"), hits(in_it, "unfounded")) == (1, 0)
    truths["e"] = {**truths["e"], "sums_up": {"impulse": 0.71}}
    founded = score(truths, said)
    assert (hits(founded, "claimed"), hits(founded, "unfounded")) == (1, 0)
    assert list(command.misses(truths, said))[-1] == "e: control () called impulse (summed up by impulse 71 %)"


def test_a_gain_that_is_all_of_a_control_may_be_named() -> None:
    rng = np.random.default_rng(3)
    rig = replace(draw_rig(FREE["cart"], "", rng), channels="xa", gain={"a": 1.004})
    case = _control(rig, True, rng)
    assert case is not None
    assert case.fitted["sensor-gain"] == pytest.approx(1.0, abs=1e-6)
    assert truth(case)["may_name"] == ["sensor-gain"]
    assert right(truth(case), result("missing_physics", {"name": "sensor-gain", "grade": "explains"}))
