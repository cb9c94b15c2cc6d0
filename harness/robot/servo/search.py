"""What a servo's log asks for beside torque, damping and dry friction: terms one after another, by evidence that holds
on what was not fitted."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.diagnosis.baseline.words import evidence
from harness.diagnosis.grading.likely import Chosen, Likely, beside_other_forms, of_steps
from harness.diagnosis.rules import MARGIN
from harness.fit.least_squares import Until
from harness.robot.servo.fit import Logs, ServoFit, fit

_GLANCE = Until(share=1e-2, iterations=4)
_LOOK = Until(share=1e-2, iterations=12)
"""Of a term: one that is far from where it acts gains little at first, and one that does not act ends at once."""
_FINALISTS, _MOST_TERMS = 3, 4
_PARTS = 4
"""Into which many logs are divided to be held out."""
_LOWER = 0.999
"""Share of a sum of squares below which another minimum is the lower one."""
_SHORT = 1.0
"""s of a free run with fewer minima: some times what a joint on its servo remembers (1/20 to 1/2 s)."""
_NEAR = 10.0
"""Evidence by which one term must be worse than another to be ruled out."""
_ENOUGH = 2.0
"""Evidence that is positive (Kass and Raftery 1995): enough where what was not fitted confirms it."""


@dataclass(frozen=True, slots=True)
class Term:
    """A piece of a servo's physics. starts : of its numbers, one set a try, from the fit without it. replaces : numbers
    of another term that its own take the place of. needs : link, a load's inertia; limit, that of the duty not known;
    gain, a duty that has a limit. said : what it is, in words. form : a number of its shape, with its start, that is
    free where that is better: other forms of one law are no second one.
    """

    name: str
    said: str
    starts: Callable[[ServoFit], list[dict[str, float]]]
    replaces: tuple[str, ...] = ()
    needs: tuple[str, ...] = ()
    form: tuple[str, float] | None = None

    def numbers(self, found: ServoFit) -> set[str]:
        """Names of all numbers that it may have."""
        return set[str]().union(*self.starts(found)) | ({self.form[0]} if self.form else set())


def _strongest(found: ServoFit) -> float:
    """Largest torque of the motor that a fit asks for, N m."""
    values = {**found.logs.known, **found.values}
    most = 0.0
    for run in found.logs.runs:
        duty = np.minimum(np.abs(run.goal - run.q) * values["gain"] * run.kp, values.get("limit", math.inf))
        most = max(most, float(np.max(duty * run.volts * run.on, initial=0.0)) * values["stall"])
    return most


def _farthest(found: ServoFit) -> float:
    """Largest duty that the errors of position ask for where nothing bounds it."""
    return max(float(np.max(np.abs(run.goal - run.q)) * run.kp) for run in found.logs.runs)


def _fastest_goal(found: ServoFit) -> float:
    rates = [np.abs(np.diff(run.goal)) / np.diff(run.t) for run in found.logs.runs]
    return float(max(np.quantile(rate, 0.98) for rate in rates))


def _cruising(found: ServoFit) -> float:
    """Speed at which the joint is under way, rad/s: the median of what is faster than half of its fastest tenth."""
    speeds = np.concatenate([np.abs(np.gradient(run.q, run.t)) for run in found.logs.runs])
    return float(np.median(speeds[speeds >= 0.5 * np.quantile(speeds, 0.9)]))


_FADES = ("exponent", 1.0)
"""Of how friction at rest fades: 2 is a Gaussian, 1 an exponential (Bo and Pavelescu 1982)."""
TERMS = (
    Term("load-friction", "friction grows with the load on the gears", lambda f: [{"load": x} for x in (0.1, 0.25)]),
    Term(
        "load-friction-by-side",
        "friction grows with the motor's torque otherwise than with the load's",
        lambda f: [{"load_motor": 0.3, "load_external": 0.08}, {"load_motor": 0.08, "load_external": 0.2}],
        replaces=("load",),
    ),
    Term(
        "rest-friction",
        "friction is larger at rest",
        lambda f: [{"f_s": 0.5 * f.values["f_k"] + 0.1 * f.logs.size("f_s"), "v_s": v} for v in (0.1, 0.5)],
        form=_FADES,
    ),
    Term(
        "load-break-away",
        "friction under the motor's torque is larger at rest",
        lambda f: [{"load_rest": 0.1, "v_s": v} for v in (0.1, 0.5)],
        form=_FADES,
    ),
    Term(
        "torque-limit",
        "the current's limit bounds the torque",
        lambda f: [{"most": x * _strongest(f)} for x in (0.85, 0.6, 0.3, 0.1)],
    ),
    Term(
        "drive-limit",
        "the drive is at its most from some error of position on",
        lambda f: [{"limit": x * _farthest(f)} for x in (0.7, 0.2)],
        needs=("limit",),
    ),
    Term(
        "concave-drive",
        "torque grows less than the duty",
        lambda f: [{"concave": x} for x in (0.03, 0.15)],
        form=("concave_power", 2.0),
    ),
    Term(
        "derivative-gain",
        "the servo brakes by its own speed",
        lambda f: [{"kd": lead * {**f.logs.known, **f.values}["gain"] * f.logs.runs[0].kp} for lead in (0.01, 0.05)],
        needs=("gain",),
    ),
    Term("gear-play", "the gears have play", lambda f: [{"play": x} for x in (0.005, 0.02)], needs=("link",)),
    Term(
        "dead-band",
        "small errors of position have no effect",
        lambda f: [{"dead": x} for x in (0.002, 0.01)],
        form=("dead_power", 2.0),
    ),
    Term(
        "goal-speed-limit",
        "the servo limits the speed of its own goal, or how fast that changes",
        lambda f: [
            *({"ramp": x} for x in (0.7 * _fastest_goal(f), _cruising(f)) if x > 0.0),
            *({"haste": _fastest_goal(f) / s, "ramp": 2.0 * _fastest_goal(f)} for s in (0.1, 0.01)),
            *({"haste": _cruising(f) / s, "ramp": _cruising(f)} for s in (0.1, 0.2)),
        ],
        form=("haste", 100.0),
    ),
)


@dataclass(frozen=True, slots=True)
class Step:
    """A term of the best fit. found : the fit that it came with. gain : evidence that the best fit loses without it.
    rivals : others that would have done nearly as well when it came, with by how much they are worse. held_out : mean
    absolute error of what was not fitted, by the best fit without it and with it, rad.
    """

    term: Term
    found: ServoFit
    gain: float
    rivals: Mapping[str, float]
    held_out: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Search:
    """base : torque, damping, inertia and dry friction. best : with all terms. steps : its terms, the one it loses most
    without first. tried : evidence of every term alone. refused : terms with evidence that what was not fitted does not
    confirm. blocks : names of what was held out. before, after : its fits by the rest, with the base and with the best.
    """

    base: ServoFit
    best: ServoFit
    steps: tuple[Step, ...]
    tried: Mapping[str, float]
    refused: tuple[str, ...]
    blocks: tuple[str, ...]
    before: tuple[ServoFit, ...]
    after: tuple[ServoFit, ...]

    @property
    def likely(self) -> Likely:
        """Which terms are missing, of those that were fitted; where the best has terms, another effect may look like
        them.
        """
        steps = [Chosen(step.term.name, step.gain, step.rivals) for step in self.steps]
        whole = _evidence(self.base, self.best) if steps else 0.0
        found = of_steps(steps, whole, {(name,): gain for name, gain in self.tried.items()}, len(TERMS))
        if not steps:
            return found
        words = self.best.memory.independent
        return beside_other_forms(found, words * (self.base.squares / self.best.squares - 1.0))


def search(
    logs: Logs, starts: Sequence[Mapping[str, float]], progress: Callable[[str], None] = lambda said: None
) -> Search:
    """Terms as long as evidence and what was not fitted ask for them. starts : of a fit without any."""
    folds, (base, origin) = held_out(logs), _based(logs, starts)
    now, steps, refused, tried = base, list[Step](), list[str](), dict[str, float]()
    first = out = _predicted(folds, now)
    while len(steps) < _MOST_TERMS:
        # beside a term the others' numbers are near their own
        begin = {} if steps or now.at_noise else origin
        ranked = _ranked(logs, now, begin, {step.term.name for step in steps} | set(refused), progress)
        if not steps and not refused:
            # of the lowest minimum, the last one
            tried = {term.name: gain for gain, term, _ in ranked}
        if not ranked or ranked[0][0] < (_ENOUGH if folds else MARGIN.value):
            break
        _, term, found = ranked[0]
        found = _restarted(found)
        gain = _evidence(now, found)
        # a term may only have led out of a worse minimum, in which the fit without it stood
        led = _lowest(logs, _less(term, [step.term for step in steps], base, found))
        if led.squares < _LOWER * now.squares:
            now, out = led, _predicted(folds, led)
            base, first = (base, first) if steps else (now, out)
            continue
        after = _predicted(folds, found)
        if _confirmed(out, after):
            rivals = {other.name: gain - worse for worse, other, _ in ranked[1:] if gain - worse < _NEAR}
            steps.append(Step(term, found, gain, rivals, (_mae(out), _mae(after))))
            now, out = found, after
        else:
            refused.append(term.name)
    now, out, steps = _needed(logs, folds, base, now, out, steps)
    return Search(base, now, tuple(steps), tried, tuple(refused), tuple(name for name, _, _ in folds), first, out)


Predicted = tuple[ServoFit, ...]


def _needed(
    logs: Logs, folds: "list[Fold]", base: ServoFit, now: ServoFit, out: Predicted, steps: list[Step]
) -> tuple[ServoFit, Predicted, list[Step]]:
    """The terms that the best fit does not do without, the one it loses most without first.

    What came first stood for others that came later: each is taken out again and the rest fitted, the least needed as
    long as evidence and what was not fitted let it go.
    """
    least, as_found = _ENOUGH if folds else MARGIN.value, len(steps) < 2
    while steps and not as_found:
        weighed = []
        for step in steps:
            others = [one.term for one in steps if one is not step]
            rest = _lowest(logs, _less(step.term, others, base, now))
            before = _predicted(folds, rest)
            held = _mae(before), _mae(out)
            weighed.append(
                (_evidence(rest, now), rest, before, replace(step, gain=_evidence(rest, now), held_out=held))
            )
        weighed.sort(key=lambda one: -one[0])
        gain, rest, before, _ = weighed[-1]
        if gain >= least and _confirmed(before, out):
            return now, out, [step for _, _, _, step in weighed]
        steps = [step for _, _, _, step in weighed[:-1]]
        now, out = rest, before
    return now, out, steps


def _less(term: Term, others: Sequence[Term], base: ServoFit, now: ServoFit) -> dict[str, float]:
    """Numbers of a fit without those of a term that none of the others has."""
    own, kept = (set[str]().union(*(one.numbers(base) for one in those)) for those in ([term], others))
    return {name: value for name, value in now.values.items() if name not in own - kept}


def _ranked(
    logs: Logs, now: ServoFit, origin: Mapping[str, float], taken: set[str], progress: Callable[[str], None]
) -> list[tuple[float, Term, ServoFit]]:
    """Terms with evidence and fit, best first: all at a glance, the first few to the end.

    origin : where the fit without any began, whose own numbers are far off where they stand for what is missing; none
    where they are not.
    """
    looked = []
    linked = all(np.all(run.load[:, 0] > 0.0) for run in logs.runs)
    has = {*(["link"] if linked else []), *(["limit"] if "limit" not in logs.known else [])}
    # a derivative gain is damping as long as the duty is nowhere at its limit
    has |= {"gain"} if {"limit", "most"} & {*logs.known, *now.values} else set()
    for term in TERMS:
        if term.name in taken or not {*term.needs} <= has:
            continue
        progress(term.name)
        kept = {name: value for name, value in now.values.items() if name not in term.replaces}
        begins = [kept, *([{**kept, **origin}] if origin else [])]
        tries = [fit(logs, {**begin, **start}, _LOOK) for begin in begins for start in term.starts(now)]
        looked.append((min(tries, key=lambda one: one.squares), term))
    looked.sort(key=lambda one: -_evidence(now, one[0]))
    ended = [(_formed(_lowest(logs, one.values), term), term) for one, term in looked[:_FINALISTS]]
    ended += looked[_FINALISTS:]
    shown = [(one, term) for one, term in ended if _shows(one)]
    return sorted(((_evidence(now, one), term, one) for one, term in shown), key=lambda found: -found[0])


def _shows(found: ServoFit) -> bool:
    """Whether play and dead band are no smaller than what half a step of the sensor makes anyway."""
    least = 0.5 * max(run.step for run in found.logs.runs)
    return all(found.values.get(name, math.inf) >= least for name in ("play", "dead"))


def _lowest(logs: Logs, start: Mapping[str, float]) -> ServoFit:
    """The fit from a start, or a lower minimum off a bound that it ended on, which a descent does not leave again."""
    found = fit(logs, start)
    off = [fit(logs, {**found.values, name: logs.size(name)}) for name in found.free if found.bound(name)]
    return _lower(found, off)


def _restarted(found: ServoFit) -> ServoFit:
    """A fit, or a lower minimum that runs lead to which are so short that a joint that stuck at a wrong place begins
    anew before the error grows; where it leaves no more than the sensor there is none.
    """
    if found.at_noise:
        return found
    short = fit(found.logs.in_runs_of(_SHORT), found.values, _LOOK)
    return _lower(found, [fit(found.logs, short.values)])


def _lower(found: ServoFit, others: Sequence[ServoFit]) -> ServoFit:
    lowest = min(others, key=lambda one: one.squares, default=found)
    return lowest if lowest.squares < _LOWER * found.squares else found


def _formed(found: ServoFit, term: Term) -> ServoFit:
    """A fit with a term, with the shape of that free where evidence asks for it."""
    if term.form is None or term.form[0] in found.values:
        return found
    name, start = term.form
    freed = fit(found.logs, {**found.values, name: start})
    return freed if _evidence(found, freed) >= _ENOUGH else found


def _evidence(before: ServoFit, after: ServoFit) -> float:
    """By which a fit is better, of as many values as its residual is independent."""
    more = len(after.free) - len(before.free)
    words = max(min(before.memory.independent, after.memory.independent) - len(after.free), 2.0)
    return evidence(before.squares, after.squares, words, more, 1.0)


Fold = tuple[str, Logs, Logs]


def held_out(logs: Logs) -> list[Fold]:
    """Name, what is fitted, what is predicted: logs of one gain at a time, else every log, else every second window."""
    gains = sorted({run.kp for run in logs.runs})
    count = len(logs.runs)
    if len(gains) > 2:
        groups = [[gains.index(run.kp)] * len(windows) for run, windows in zip(logs.runs, logs.windows, strict=True)]
        names = [f"gain {gain:g}" for gain in gains]
    elif count > 1:
        names = [f"logs {k + 1} of {min(count, _PARTS)}" for k in range(min(count, _PARTS))]
        groups = [[i % len(names)] * len(windows) for i, windows in enumerate(logs.windows)]
    elif len(logs.windows[0]) > 1:
        names = ["every second window, from the first", "from the second"]
        groups = [[j % 2 for j in range(len(logs.windows[0]))]]
    else:
        return []
    return [
        (
            name,
            logs.part([[g != k for g in own] for own in groups]),
            logs.part([[g == k for g in own] for own in groups]),
        )
        for k, name in enumerate(names)
    ]


def _predicted(folds: list[Fold], found: ServoFit) -> tuple[ServoFit, ...]:
    """What was held out, by fits of the rest that begin at another."""
    return tuple(fit(rest, found.values).under(out) for _, rest, out in folds)


def _mae(parts: tuple[ServoFit, ...]) -> float:
    """Mean absolute error, rad; of nothing held out nan."""
    return float(np.mean([one.mae for one in parts])) if parts else math.nan


def _confirmed(before: tuple[ServoFit, ...], after: tuple[ServoFit, ...]) -> bool:
    """Whether what was not fitted is predicted better, or nothing could be held out."""
    gains = [math.log(b.squares / a.squares) for b, a in zip(before, after, strict=True)]
    return not gains or float(np.mean(gains)) > 0.0


def _based(logs: Logs, starts: Sequence[Mapping[str, float]]) -> tuple[ServoFit, Mapping[str, float]]:
    """The fit that descends farthest from some starts, all at a glance, the best to the end; and where it began."""
    looked = [(float(np.sum(logs.residual(start) ** 2)), i) for i, start in enumerate(starts)]
    tries = [(fit(logs, starts[i], _GLANCE), starts[i]) for _, i in sorted(looked)[:2]]
    nearest, start = min(tries, key=lambda one: one[0].squares)
    return fit(logs, nearest.values), start
