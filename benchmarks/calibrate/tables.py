"""Tables of what has no name: how much better they predict, whether their band holds the truth, how often one is kept.

Of ten recordings six are machines whose static main effect no catalogue holds, two have small effects alone, and two
are controls whose misfit is random: it says one thing a stroke and hangs on nothing.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.calibrate.calibration import Calibration, stands
from benchmarks.calibrate.machine_draws import based, drawn
from benchmarks.calibrate.plant_cases import seen as begun
from benchmarks.calibrate.plant_folder import measured
from benchmarks.calibrate.static_force import static_force
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.grading.misfit import misfit
from harness.diagnosis.grading.prediction import held_out, ratio
from harness.diagnosis.outcome import Table
from harness.diagnosis.parameters import base_of
from harness.diagnosis.problem import Problem
from harness.diagnosis.residual_tests.structure import Left, left_by
from harness.diagnosis.rules import TABLE_BAND, TABLE_BETTER, TABLE_ERRORS, TABLE_WORDS
from harness.diagnosis.tables.beside import MotionLeft
from harness.diagnosis.tables.drawn import table_of
from harness.kernels.solve import Scales
from harness.model.model import Model
from harness.proof.machines.kinds import CONTROL, TABLE
from harness.proof.statistics import Median, Rate

RANDOM = "random"
_GROUPS = (TABLE, TABLE, TABLE, CONTROL, RANDOM) * 2
_SIZE = 0.01
"""Of the motion: a random misfit."""
GOAL, MOST = 0.7, 1.05
"""Held-out error over the base's that a table should reach, and that one which should not be there may."""
WITHDRAWN = 0.97
"""Share of random controls that should get no table."""
WITHIN, HOLDS = 0.9, 0.9
"""Share of the swept range on which the band of two standard errors should hold the truth, and of tables that do."""


@dataclass(frozen=True, slots=True)
class Row:
    """A recording: its group, its main effect and what that is a function of; what is kept, and how it predicts.

    why : where no table was looked for. kept : the form, "" for none. ratio : held-out error over the base's.
    held : share of the range on which two standard errors hold the truth, nan where the form is another one.
    """

    group: str
    main: str
    form: str
    cycles: float
    why: str = ""
    kept: str = ""
    ratio: float = 1.0
    held: float = math.nan


def measure(seed: int, index: int) -> Row:
    """A new recording. Raises HarnessError for what cannot be diagnosed."""
    group = _GROUPS[index % len(_GROUPS)]
    rng = np.random.default_rng([seed, index, 7]) if group == RANDOM else None
    return _row(*drawn(seed, index, CONTROL if group == RANDOM else group), rng)


def of_plant(folder: Path) -> Calibration:
    """The same for recordings that ``python -m benchmarks.recordings machines`` left; the seed is not used."""
    return Calibration(partial(measured, _row, folder), said, ABOUT)


def _row(recording: Recording, truth: Mapping[str, Any], rng: np.random.Generator | None = None) -> Row:
    problem, base, scales = based(recording, truth)
    if rng is not None:
        problem = _with_random_misfit(problem, base.shown.y, scales, rng)
        base, scales = baseline(problem)
    start = begun(problem, base, scales)
    problem, base = start.problem, start.base
    form = truth.get("table", {}).get("form", "")
    group = RANDOM if rng is not None else str(truth["group"])
    row = Row(group, truth["dominant"] or "", form, float(truth["cycles"]))
    if left_by(base, problem, scales.omega, base) is not Left.STRUCTURE:
        return replace(row, why="nothing but noise is left")
    seen = misfit(problem, base, scales)
    before = held_out(seen.base, seen.problem, seen.scales, seen.strokes)
    if before is None:
        return replace(row, why="too short for blocks")
    left = MotionLeft(seen, seen.base.model, base_of(seen.base.free))
    kept = left.tabulated(before)
    if not kept:
        return row
    best = left.finished(kept[0])
    row = replace(row, kept=best.rung.said, ratio=ratio(best.held, before))
    number = number_of(form, best.rung.said)
    if group != TABLE or number is None:
        return row
    first = len(seen.base.model.terms)
    numbers = tuple(first + i for i in number)
    table = table_of(best.fit, seen.strokes, seen.scales, numbers, form, row.ratio)
    return replace(row, held=_held(table, truth, best.fit.model))


def _with_random_misfit(
    problem: Problem, shown: Mapping[str, FloatArray], scales: Scales, rng: np.random.Generator
) -> Problem:
    """One channel as the base model has it, with its noise and a random misfit with a memory of a quarter period."""
    channel = next(iter(problem.channels))
    t, y, noise = problem.t, shown[channel], problem.noise[channel]
    memory = np.exp(-np.diff(t, prepend=t[0]) * scales.omega / (0.5 * math.pi))
    left = np.zeros(t.size)
    for i, draw in enumerate(rng.standard_normal(t.size).tolist()):
        left[i] = memory[i] * (left[i - 1] if i else 0.0) + math.sqrt(max(1.0 - memory[i] ** 2, 0.0)) * draw
    size = _SIZE * float(np.max(np.abs(y)))
    spoiled = y + size * left + noise.sigma * rng.standard_normal(t.size)
    return replace(
        problem, channels={channel: spoiled}, noise={channel: noise}, weight={channel: problem.weight[channel]}
    )


def number_of(form: str, kept: str) -> tuple[int, ...] | None:
    """Which of the tables kept say a true law of this form."""
    if form == kept:
        return (0, 1) if kept == "f(v)" else (0,)
    return {("f(v)", "f(|v|) sgn v"): (0,), ("f(v)", "f(x) + f(v)"): (1,), ("f(x)", "f(x) + f(v)"): (0,)}.get(
        (form, kept)
    )


def _held(table: Table, truth: Mapping[str, Any], model: Model) -> float:
    """Share of the swept range on which two standard errors about the table hold the true force, gauge taken off."""
    at, force = np.array(truth["table"]["at"]), static_force(truth) * model.m / truth["m"]
    # the true curve is of the distance from the spring's zero; the table's of that from where the fit has it
    if table.of == "x":
        at = at + truth["nuisances"].get("zero", 0.0) - model.offset

    def true(z: FloatArray) -> FloatArray:
        found = np.interp(z, at, force)
        return np.asarray(0.5 * (found - np.interp(-z, at, force)) if table.of == "|v|" else found)

    return within(table, true)


def within(table: Table, true: Callable[[FloatArray], FloatArray]) -> float:
    """Share of the swept range on which two standard errors hold a true force, gauge taken off."""

    def held_by_base(z: FloatArray) -> FloatArray:
        columns = [np.ones(z.size)] if "constant" in table.gauge else []
        columns += [z] if "line" in table.gauge else []
        return np.column_stack(columns) if columns else np.zeros((z.size, 1))

    parts = np.linalg.lstsq(held_by_base(table.swept), true(table.swept), rcond=None)[0]
    left = true(table.at) - held_by_base(table.at) @ parts
    inside = (table.at >= table.swept[0]) & (table.at <= table.swept[-1])
    return float(np.mean((np.abs(left - table.force) <= 2.0 * table.stderr)[inside]))


def said(rows: Sequence[Row]) -> Iterator[str]:
    """Figures against their goals, and every recording."""
    tables = [r for r in rows if r.group == TABLE]
    looked = [r for r in tables if not r.why]
    yield from _predicted("static main effects", tables)
    yield from _predicted("of those in which the base leaves structure", looked)
    said_of = [r for r in looked if not math.isnan(r.held)]
    bands = Rate.of([r.held >= WITHIN for r in said_of])
    wanted = f"(goal {100 * HOLDS:.0f} %)"
    yield f"two standard errors hold the truth on {100 * WITHIN:.0f} % of the range: {rate_of(bands)} {wanted}"
    for group, goal in ((RANDOM, WITHDRAWN), (CONTROL, math.nan)):
        here = [r for r in rows if r.group == group]
        kept = [r for r in here if r.kept]
        wanted = "" if math.isnan(goal) else f" (goal {100.0 * goal:.0f} %)"
        borne = f"of the others {sum(r.ratio <= MOST for r in kept)} of {len(kept)} at most {MOST}"
        yield f"{group}: withdrawn {rate_of(Rate.of([not r.kept for r in here]))}{wanted}; {borne}"
    for r in sorted(rows, key=lambda r: (r.group, r.form, r.main)):
        what = r.why or (f"{r.kept} {r.ratio:.2f} band {r.held:.2f}" if r.kept else "withdrawn")
        yield f"  {r.group:16s} {r.main or '-':24s} {r.form or '-':12s} {r.cycles:5.1f} cycles: {what}"
    quick = [r.ratio for r in looked]
    fine = bool(quick) and bool(np.mean(np.array(quick) <= GOAL) >= 0.8 and np.median(quick) <= 0.5)
    chance = float(np.mean([not r.kept for r in rows if r.group == RANDOM] or [True])) >= WITHDRAWN
    for rule in (TABLE_BETTER, TABLE_ERRORS, TABLE_WORDS):
        yield stands(rule, fine and chance, f"{len(looked)} static laws, {sum(r.group == RANDOM for r in rows)} random")
    yield stands(TABLE_BAND, (bands.value or 0.0) >= HOLDS, f"{len(said_of)} curves")


def _predicted(what: str, rows: Sequence[Row]) -> Iterator[str]:
    ratios = [r.ratio for r in rows]
    if ratios:
        median = Median.of(ratios).value
        yield f"{what}: held-out error at most {GOAL} of the base's in {rate_of(Rate.of([r <= GOAL for r in ratios]))}"
        yield f"  (goal 80 %), median {median:.2f} (goal 0.5)"


def rate_of(rate: Rate) -> str:
    """Hits, cases, and the share of them."""
    share = "-" if rate.value is None else f"{100.0 * rate.value:.0f} %"
    return f"{rate.hits} of {rate.cases} ({share})"


ABOUT = "tables of static laws of no catalogue: prediction, band, and how often one is kept where none should be"
CALIBRATION = Calibration(measure, said, ABOUT)
