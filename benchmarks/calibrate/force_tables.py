"""Tables of a fitted force: how they predict, whether their band holds the truth, and how often one is kept in vain.

A machine is moved along waves by a servo that is exact: its motion is given, and the force that it takes follows from
the laws without a simulation. The force has noise of .1 to .5 %. Of eight machines two have a force of the place and
two one of the speed that no catalogue holds, two one of both at once; one has no law but the base's, and one a law of
the catalogue, which the model has too.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.calibrate.calibration import Calibration, stands
from benchmarks.calibrate.tables import GOAL, WITHIN, number_of, rate_of, within
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.diagnosis.baseline.base_fit import driven_scales
from harness.diagnosis.fit.model_fit import fit
from harness.diagnosis.grading.prediction import ratio
from harness.diagnosis.inverse_dynamics.strokes import force_words
from harness.diagnosis.parameters import free_of
from harness.diagnosis.pipeline import prepare
from harness.diagnosis.problems.asked import inverse_force
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.request import Asked
from harness.diagnosis.rules import PATH_AGAIN, TABLE_BETTER, TABLE_ERRORS, TABLE_WORDS
from harness.diagnosis.tables.beside import ForceLeft, time_again
from harness.diagnosis.tables.drawn import curves, table_of
from harness.model.model import Model, ModelTerm, Restoring
from harness.model.registry import NAMED
from harness.model.term import Slot
from harness.proof.plant.base import log_uniform
from harness.proof.statistics import Median, Rate

CONTROL, CATALOGUE, BOTH = "control", "named", "f(x, v)"
_GROUPS = ("f(x)", "f(v)", BOTH, CONTROL, "f(x)", "f(v)", BOTH, CATALOGUE)
_WAVES = 5
_PERIODS = (20.0, 40.0)
"""Of the slowest wave."""
_NOISE = (0.001, 0.005)
"""Of the force: share of its rms."""
_STRENGTH = (0.05, 0.3)
"""Rms of a law over that of the force without it."""
_SENSOR = 1e-5
"""Noise of x over its reach."""
Law = Callable[[FloatArray, FloatArray], FloatArray]


@dataclass(frozen=True, slots=True)
class Row:
    """A machine: its group and law; what is kept, "" for nothing; the held-out error over the base's.

    held : share of the range on which two standard errors hold the truth, nan where the table is of another form.
    again, fading : share of the time in cells of the plane that are seen again, of its motion and of one that fades.
    """

    group: str
    law: str
    again: float = 1.0
    fading: float = 0.0
    kept: str = ""
    ratio: float = 1.0
    held: float = math.nan


@dataclass(frozen=True, slots=True)
class Moved:
    """A machine and its recording. law : beside the base, None where the model has all of it."""

    name: str
    model: Model
    law: Law | None
    recording: Recording


def _nothing(x: FloatArray, v: FloatArray) -> FloatArray:
    return np.zeros(x.size)


def _laws(group: str, rng: np.random.Generator) -> tuple[str, Law]:
    """A law of the place and the speed, both as shares of the largest."""
    place, width, sharp = rng.uniform(-0.4, 0.4), rng.uniform(0.2, 0.45), rng.uniform(1.2, 2.2)
    turned = 1.0 if rng.random() < 0.5 else -1.0

    def bump(z: FloatArray) -> FloatArray:
        return np.asarray(np.exp(-(((z - place) / width) ** 2)))

    choice: dict[str, dict[str, Law]] = {
        "f(x)": {
            "double well": lambda x, v: turned * (np.exp(-((x / width) ** 2)) * x * 2.0 - 0.4 * x**3),
            "bump": lambda x, v: turned * bump(x),
            "magnet": lambda x, v: turned * (x - place) / width * bump(x),
        },
        "f(v)": {
            "wavy": lambda x, v: turned * np.sin(math.pi * sharp * v),
            "eddy": lambda x, v: 2.0 * (v / width) / (1.0 + (v / width) ** 2),
            "hump": lambda x, v: np.sign(v) * (np.abs(v) / width * np.exp(0.5 * (1.0 - (v / width) ** 2))) ** 2,
        },
        BOTH: {
            "damping by place": lambda x, v: v * (turned * x + 0.7 * bump(x)),
            "fluid by place": lambda x, v: v * np.abs(v) * np.tanh((x - place) / width),
            "friction by both": lambda x, v: np.tanh(v / 0.15) * bump(x) * (1.0 + sharp * np.exp(-np.abs(v) / 0.3)),
        },
    }
    names = list(choice[group])
    name = names[int(rng.integers(len(names)))]
    return name, choice[group][name]


def moved(seed: int, index: int) -> Moved:
    """A machine along waves."""
    rng, group = np.random.default_rng([seed, 11, index]), _GROUPS[index % len(_GROUPS)]
    omega, reach, m = (log_uniform(rng, *r) for r in ((2.0, 20.0), (0.02, 0.5), (0.3, 5.0)))
    duration = float(rng.uniform(*_PERIODS)) * 2.0 * math.pi / omega
    step = 2.0 * math.pi / omega / rng.uniform(150.0, 300.0)
    t = np.asarray(np.arange(int(duration / step)) * step, dtype=np.float64)
    rates = omega * (1.0 + np.arange(_WAVES) * rng.uniform(0.3, 0.6) + rng.uniform(0.0, 0.2, _WAVES))
    size, phase = rng.uniform(0.4, 1.0, _WAVES) / np.sqrt(rates / omega), rng.uniform(0.0, 2.0 * math.pi, _WAVES)
    waves = [size[:, None] * rates[:, None] ** k * np.sin(np.outer(rates, t) + (phase + 0.5 * math.pi * k)[:, None])
             for k in range(3)]  # fmt: skip
    x, v, a = (np.asarray(np.sum(w, axis=0), dtype=np.float64) for w in waves)
    scale = reach / np.max(np.abs(x))
    x, v, a = (np.asarray(scale * y, dtype=np.float64) for y in (x, v, a))
    spring = rng.random() < 0.5
    typical = m * float(np.std(a))
    model = Model(
        m,
        float(rng.uniform(0.1, 0.5)) * typical / float(np.std(v)),
        float(rng.uniform(0.3, 1.0)) * typical / float(np.std(x)) if spring else 0.0,
        float(rng.uniform(0.1, 0.5)) * typical,
        restoring=Restoring.SPRING if spring else Restoring.NONE,
    )
    name, law, whole = "", None, model
    strength = log_uniform(rng, *_STRENGTH)
    plain = inverse_force(model, t, x, v, a)
    if group == CATALOGUE:
        whole = _with_named(model, rng, t, x, v, a, strength * float(np.std(plain)))
        name, plain = whole.terms[0].term.name, inverse_force(whole, t, x, v, a)
    elif group != CONTROL:
        name, shape = _laws(group, rng)
        furthest, fastest = float(np.max(np.abs(x))), float(np.max(np.abs(v)))
        gain = strength * float(np.std(plain)) / float(np.std(shape(x / furthest, v / fastest)))

        def law(x: FloatArray, v: FloatArray) -> FloatArray:
            return np.asarray(gain * shape(x / furthest, v / fastest))

        plain = plain + law(x, v)
    noise = log_uniform(rng, *_NOISE) * float(np.std(plain))
    u = np.asarray(plain + noise * rng.standard_normal(t.size))
    seen = x + _SENSOR * reach * rng.standard_normal(t.size)
    return Moved(name, whole, law, Recording(t, {"x": seen, "u": u}))


def _with_named(
    model: Model, rng: np.random.Generator, t: FloatArray, x: FloatArray, v: FloatArray, a: FloatArray, size: float
) -> Model:
    """The model with a law of the catalogue that hangs on place or speed, so strong that it adds ``size``."""
    able = [
        term
        for term in NAMED
        if term.slot is Slot.SMOOTH and term.amplitude is not None and not term.changes_in_time and not term.needs
        and term.phase is None and len(term.parameters) == 1
    ]  # fmt: skip
    term = able[int(rng.integers(len(able)))]
    one = model.with_terms(ModelTerm(term, (1.0,)))
    added = inverse_force(one, t, x, v, a) - inverse_force(model, t, x, v, a)
    return model.with_terms(ModelTerm(term, (size / max(float(np.std(added)), 1e-300),)))


def left_of(machine: Moved) -> tuple[ForceLeft, InverseDynamics]:
    """What the model of a machine, its law apart, leaves of the force; and the problem. Raises HarnessError."""
    # as a servo's, whose motion nobody has to follow, but with all that moves
    problem, _ = prepare(machine.recording, Asked(machine.model.restoring, guarded=True))
    assert isinstance(problem, InverseDynamics)
    problem = replace(problem, guarded=False)
    first = replace(problem.first, terms=machine.model.terms)
    scales = driven_scales(problem, problem.first)
    start = fit(first, problem, free_of(first, problem.base_names), scales)
    return ForceLeft(start, problem, force_words(start.memory, problem.measured), scales), problem


def measure(seed: int, index: int) -> Row:
    """A machine, and the tables of what its base leaves. Raises HarnessError for what cannot be fitted."""
    group, machine = _GROUPS[index % len(_GROUPS)], moved(seed, index)
    left, _ = left_of(machine)
    start, measured, words, scales = left.start, left.problem.measured, left.words, left.scales
    before = left.predicted()
    row = Row(group, machine.name, time_again(measured.t, measured.x, measured.v), _fading(seed, index))
    kept = () if before is None else left.tabulated(before)
    if before is None or not kept:
        return row
    best = kept[0]
    row = replace(row, kept=best.rung.said, ratio=ratio(best.held, before))
    chosen = number_of(group, best.rung.said)
    if group == BOTH or chosen is None or machine.law is None:
        return row
    law, offset, named = machine.law, best.fit.model.offset, len(start.model.terms)
    numbers, form = next(c for c in curves(best, named) if c[0][0] == named + chosen[0])
    table = table_of(best.fit, words.pieces, scales, numbers, form, row.ratio)

    def true(z: FloatArray) -> FloatArray:
        none = np.zeros(z.size)
        if table.of == "x":
            return law(z + offset, none)
        return 0.5 * (law(none, z) - law(none, -z)) if table.of == "|v|" else law(none, z)

    return replace(row, held=within(table, true))


def _fading(seed: int, index: int) -> float:
    """Time in cells of the plane that are seen again, of a swing that fades to .7 or less."""
    rng = np.random.default_rng([seed, 12, index])
    phase = np.linspace(0.0, 2.0 * math.pi * rng.uniform(8.0, 40.0), 6000)
    x = np.exp(math.log(rng.uniform(0.1, 0.7)) * phase / phase[-1]) * np.cos(phase)
    return time_again(phase, x, np.gradient(x, phase))


def said(rows: Sequence[Row]) -> Iterator[str]:
    """Figures against their goals, and every machine."""
    single = [r for r in rows if r.group in ("f(x)", "f(v)")]
    both = [r for r in rows if r.group == BOTH]
    sound = [r for r in rows if r.group in (CONTROL, CATALOGUE)]
    for what, some in (("laws of x or of v", single), ("laws of both", both)):
        if some:
            good = rate_of(Rate.of([r.ratio <= GOAL for r in some]))
            median = Median.of([r.ratio for r in some]).value
            yield f"{what}: held-out error at most {GOAL} of the base's in {good} (goal 80 %), median {median:.2f}"
    bands = rate_of(Rate.of([r.held >= WITHIN for r in single if not math.isnan(r.held)]))
    yield f"two standard errors hold the truth on {100 * WITHIN:.0f} % of the range: {bands} (goal 90 %)"
    yield f"laws of both, taken by {BOTH}: {rate_of(Rate.of([r.kept.startswith(BOTH) for r in both]))}"
    sums = rate_of(Rate.of([r.kept == "f(x) + f(v)" for r in both]))
    yield f"laws of both, taken by a sum: {sums}"
    yield f"laws of x or of v, taken by {BOTH}: {rate_of(Rate.of([r.kept.startswith(BOTH) for r in single]))}"
    yield f"no law left out: withdrawn {rate_of(Rate.of([not r.kept for r in sound]))} (goal 97 %)"
    least, most = min(r.again for r in rows), max(r.fading for r in rows)
    yield f"time in cells that are seen again: {least:.2f} at least, {most:.2f} at most where a motion fades"
    for r in sorted(rows, key=lambda r: (r.group, r.law)):
        what = f"{r.kept} {r.ratio:.2f} band {r.held:.2f}" if r.kept else "withdrawn"
        yield f"  {r.group:10s} {r.law or '-':24s}: {what}"
    fine = bool(single) and float(np.mean([r.ratio <= GOAL for r in single])) >= 0.8 and not any(r.kept for r in sound)
    for rule in (TABLE_BETTER, TABLE_ERRORS, TABLE_WORDS):
        yield stands(rule, fine, f"{len(single)} laws of x or of v, {len(both)} of both, {len(sound)} without any")
    yield stands(PATH_AGAIN, most < PATH_AGAIN.value < least, f"{len(rows)} motions of either kind")


CALIBRATION = Calibration(
    measure, said, "tables of a fitted force: prediction, band, and how often one is kept in vain"
)
