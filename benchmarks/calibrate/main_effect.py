"""Machines with one large omission among small ones: what is named, listed, wrong, claimed at which values of rules."""

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

from benchmarks.calibrate.calibration import Calibration, stands
from benchmarks.calibrate.machine_draws import based, drawn
from benchmarks.calibrate.plant_cases import seen
from benchmarks.calibrate.plant_folder import measured
from harness.core.recording import Recording
from harness.diagnosis.baseline import words
from harness.diagnosis.grading import grade as grading
from harness.diagnosis.grading.grade import Graded, decided, grade
from harness.diagnosis.grading.misfit import misfit
from harness.diagnosis.grading.prediction import ratio
from harness.diagnosis.outcome import Grade
from harness.diagnosis.residual_tests.structure import Left, left_by
from harness.diagnosis.rules import (
    CHANCE,
    GAIN,
    HELD_OUT,
    LEAST_CYCLES,
    LEAST_RATIO,
    MARGIN,
    MOST_WORDS,
    RUN_BETTER,
    RUNS_ON_BETTER,
    SAME_CLOCK,
    SHARE_OF_EXCESS,
    SHARE_OF_MISFIT,
    Rule,
)
from harness.proof.machines.kinds import CONTROL, MAIN, UNNAMED
from harness.proof.plant.effects import FAMILY_OF_MACHINES
from harness.proof.statistics import Rate

Setting = tuple[float, ...]
TRIED: Mapping[str, tuple[Rule, tuple[float, ...]]] = {
    "LEAST_RATIO": (LEAST_RATIO, (1.05, 1.1, 1.15, 1.25)),
    "MARGIN": (MARGIN, (4.0, 6.0, 8.0)),
    "SHARE_OF_EXCESS": (SHARE_OF_EXCESS, (0.5, 0.6, 0.7)),
    "HELD_OUT": (HELD_OUT, (0.8, 0.9, 1.0)),
    "LEAST_CYCLES": (LEAST_CYCLES, (6.0, 8.0)),
    "RUN_BETTER": (RUN_BETTER, (0.5, 0.7, 0.85)),
    "RUNS_ON_BETTER": (RUNS_ON_BETTER, (0.0, 0.5, 0.7, 0.85)),
    "CHANCE": (CHANCE, (0.0, 0.5, 0.6, 0.7, 0.8, 0.9)),
    "SHARE_OF_MISFIT": (SHARE_OF_MISFIT, (0.4, 0.5)),
    "MOST_WORDS": (MOST_WORDS, (30.0, 60.0, 120.0)),
}
"""Rules by their constant, and the values tried: of the first five every combination, of the others one at a time."""
_CROSSED = 5
WORTH_A_PLACE = 0.1
"""Share of true ones from which a kind of law is worth a place in lists: a name of four of which one is true is true in
a quarter, and one that is true less than half as often only makes them longer."""
MOST_WRONG = 0.05
"""Share of main effects called by a wrong name that is borne, and of controls that are claimed to have one."""


@dataclass(frozen=True, slots=True)
class Answer:
    """Grade and names at some values of the rules."""

    grade: Grade | None
    names: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Row:
    """A recording: its true answer, how many cycles, what was seen of each name, and the answer at each setting.

    finalists : name, gain, share, held-out ratio, free-run ratio, clock.
    """

    truth: Mapping[str, Any]
    cycles: float
    finalists: tuple[tuple[str, float, float, float, float, bool], ...]
    answers: Mapping[Setting, Answer]


def settings() -> list[Setting]:
    """Values of the rules of ``TRIED``, in their order; the values that the rules have come first."""
    now = tuple(rule.value for rule, _ in TRIED.values())
    crossed = [
        (*some, *now[_CROSSED:])
        for some in product(*(dict.fromkeys((rule.value, *values)) for rule, values in list(TRIED.values())[:_CROSSED]))
    ]
    single = [(*now[:i], v, *now[i + 1 :]) for i, (_, values) in enumerate(TRIED.values()) for v in values]
    return list(dict.fromkeys((now, *crossed, *single)))


@contextmanager
def _instead(setting: Setting) -> Iterator[None]:
    """Grading with other values of its rules, for a while."""
    known = [(module, name) for module in (grading, words) for name in TRIED if hasattr(module, name)]
    values = {name: replace(rule, value=v) for (name, (rule, _)), v in zip(TRIED.items(), setting, strict=True)}
    try:
        for module, name in known:
            setattr(module, name, values[name])
        yield
    finally:
        for module, name in known:
            setattr(module, name, TRIED[name][0])


def _in_words(found: Graded, most: float) -> Graded:
    """Finalists as if a misfit had at most so many words."""
    if not found.finalists:
        return found
    now, then = found.misfit, replace(found.misfit, words=min(float(found.misfit.strokes.count), most))
    noise = now.noise_left(min((f.fit for f in found.finalists), key=lambda f: f.chi2))

    def gain(one: grading.Finalist) -> float:
        return one.gain + then.evidence_of(one.fit, noise) - now.evidence_of(one.fit, noise)

    seen = (replace(f, gain=gain(f)) for f in found.finalists)
    return replace(found, misfit=then, finalists=tuple(sorted(seen, key=lambda f: -f.gain)))


def graded_of(recording: Recording, truth: Mapping[str, Any]) -> Graded | None:
    """The grades of a recording; None where the base model leaves no structure. Raises HarnessError."""
    start = seen(*based(recording, truth))
    if left_by(start.base, start.problem, start.scales.omega, start.base) is not Left.STRUCTURE:
        return None
    return grade(misfit(start.problem, start.base, start.scales))


def _row(recording: Recording, truth: Mapping[str, Any]) -> Row:
    said = {key: value for key, value in truth.items() if key not in ("plant", "table")}
    found = graded_of(recording, truth)
    if found is None:
        return Row(said, math.nan, (), dict.fromkeys(settings(), Answer(None, ())))
    answers = {}
    for setting in settings():
        with _instead(setting):
            answer = decided(_in_words(found, setting[-1]))
        answers[setting] = Answer(answer.grade, tuple(f.name for f in answer.named))
    seen = tuple(
        (f.name, f.gain, f.share, ratio(f.held, found.base_held), ratio(f.run, found.base_run), f.clock)
        for f in found.finalists
    )
    return Row(said, found.misfit.strokes.cycles, seen, answers)


def measure(seed: int, index: int) -> Row:
    """A new recording of a machine: of ten, six have a main effect, three small ones alone, one what no catalogue has.

    Raises HarnessError for what cannot be diagnosed.
    """
    return _row(*drawn(seed, index, _GROUPS[index % len(_GROUPS)]))


_GROUPS = (MAIN, CONTROL, MAIN, MAIN, CONTROL, MAIN, UNNAMED, MAIN, CONTROL, MAIN)


def of_plant(folder: Path) -> Calibration:
    """The same for recordings that ``python -m benchmarks.recordings machines`` left; the seed is not used."""
    return Calibration(partial(measured, _row, folder), said, ABOUT)


@dataclass(frozen=True, slots=True)
class Counts:
    """Recordings with a main effect: named, named or listed, called something else, called nothing; controls claimed.

    misled : effects of no catalogue called one of another family.
    """

    named: Rate
    listed: Rate
    wrong: Rate
    silent: Rate
    claimed: Rate
    misled: Rate

    @classmethod
    def of(cls, rows: Sequence[Row], setting: Setting) -> "Counts":
        """At these values of the rules."""
        mains = [(r.truth, r.answers[setting]) for r in rows if r.truth["group"] == MAIN]
        controls = [(r.truth, _main(r.answers[setting])) for r in rows if not r.truth["dominant"]]
        alien = [(r.truth, _main(r.answers[setting])) for r in rows if r.truth["group"] == UNNAMED]
        return cls(
            Rate.of([_main(a) == t["dominant"] for t, a in mains]),
            Rate.of([a.grade in (Grade.MAIN, Grade.ONE_OF) and t["dominant"] in a.names for t, a in mains]),
            Rate.of([_main(a) not in ("", t["dominant"]) for t, a in mains]),
            Rate.of([a.grade not in (Grade.MAIN, Grade.ONE_OF) for _, a in mains]),
            Rate.of([bool(name) and name not in t["may_name"] for t, name in controls]),
            Rate.of([bool(name) and FAMILY_OF_MACHINES.get(name) not in t["families"] for t, name in alien]),
        )

    @property
    def line(self) -> str:
        """Hits of cases, in the order of ``HEAD``."""
        rates = (self.named, self.listed, self.wrong, self.silent, self.claimed, self.misled)
        return " ".join(f"{f'{one.hits}/{one.cases}':>8s}" for one in rates)


HEAD = " ".join(f"{name:>8s}" for name in ("named", "listed", "wrong", "silent", "claimed", "misled"))


def _main(answer: Answer) -> str:
    return answer.names[0] if answer.grade is Grade.MAIN else ""


def said(rows: Sequence[Row]) -> Iterator[str]:
    """Tables over the values tried, what was confused at the values of the rules, and which rules stand."""
    now = settings()[0]
    yield f"{'':32s} {HEAD}"
    yield f"{'values of the rules':32s} {Counts.of(rows, now).line}"
    for i, (rule, values) in enumerate(TRIED.values()):
        for value in values:
            mark = "*" if value == rule.value else ""
            counts = Counts.of(rows, (*now[:i], value, *now[i + 1 :]))
            yield f"{rule.name + f' {value:.4g}{mark}':32s} {counts.line}"
    yield from _best(rows)
    yield from _confused(rows, now)
    yield _in_step(rows)
    for i, (rule, values) in enumerate(TRIED.values()):
        yield _judged(rows, now, i, rule, values)


def _judged(rows: Sequence[Row], now: Setting, i: int, rule: Rule, values: Sequence[float]) -> str:
    """Whether no other value tried of one rule names more without naming more wrongly, and what is wrong is borne."""
    here = Counts.of(rows, now)
    falsely = here.wrong.hits + here.claimed.hits
    better = []
    for value in values:
        there = Counts.of(rows, (*now[:i], value, *now[i + 1 :]))
        if there.named.hits > here.named.hits and there.wrong.hits + there.claimed.hits <= falsely:
            better.append(f"{value:.4g} names {there.named.hits}")
    borne = all(rate.value is None or rate.value <= MOST_WRONG for rate in (here.wrong, here.claimed))
    why = f"{', '.join(better)} of {here.named.cases} with no more falsely" if better else "no value tried is better"
    return stands(rule, borne and not better, why if borne else f"{falsely} falsely; {why}")


def _in_step(rows: Sequence[Row]) -> str:
    """How often a law in step with the motion, which takes most of a misfit and predicts, is the main effect."""
    right = [
        name == row.truth["dominant"]
        for row in rows
        for name, gain, share, held, _, clock in row.finalists
        if clock and gain >= GAIN.value and share >= SHARE_OF_EXCESS.value and held <= HELD_OUT.value
    ]
    seldom = sum(right) < WORTH_A_PLACE * len(right) or not right
    return stands(SAME_CLOCK, seldom, f"of {len(right)} laws in step that could be listed {sum(right)} are true")


_FEW = 12


def _best(rows: Sequence[Row]) -> Iterator[str]:
    """The combinations that name most, for each number of false names."""
    crossed = [(setting, Counts.of(rows, setting)) for setting in settings()]
    shown: dict[int, tuple[Setting, Counts]] = {}
    for setting, counts in crossed:
        falsely = counts.wrong.hits + counts.claimed.hits
        most = (counts.named.hits, counts.listed.hits)
        if falsely not in shown or most > (shown[falsely][1].named.hits, shown[falsely][1].listed.hits):
            shown[falsely] = (setting, counts)
    yield "most named for so many wrong or claimed: " + ", ".join(rule.name for rule, _ in TRIED.values())
    for _, (setting, counts) in sorted(shown.items())[:_FEW]:
        yield f"{' '.join(f'{value:.4g}' for value in setting):32s} {counts.line}"


def _confused(rows: Sequence[Row], now: Setting) -> Iterator[str]:
    """Every recording whose answer is not the true one, with what was seen of the first names."""
    for row in rows:
        answer, want = row.answers[now], row.truth["dominant"] or "control"
        if _main(answer) in (want, *row.truth["may_name"]) or (want == "control" and not _main(answer)):
            continue
        seen = "; ".join(f"{n} {g:.3g} {s:.2f} {h:.2f} {r:.2f}" for n, g, s, h, r, _ in row.finalists[:3])
        called = f"{answer.grade.value if answer.grade else 'nothing'}: {', '.join(answer.names)}"
        yield f"{want} called {called} ({row.cycles:.3g} cycles; gain share held run: {seen})"


ABOUT = "named, listed, wrong, claimed on machines with one large omission among small ones"
CALIBRATION = Calibration(measure, said, ABOUT)
