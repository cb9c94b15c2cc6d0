"""The game of a mismatch: engine, parameters and terms put right in every order; what each brings is its share.

Noise, and what the refined model leaves beyond it, are taken off first: what is divided is the distance of a simulation
from the refined model, in windows of about a period restarted from the recording's smoothed state. Shares are Shapley
values: what each player brings, averaged over all orders in which the players may come (L. S. Shapley, A value for
n-person games, Contributions to the Theory of Games II (1953) 307-317).

How sure they are: a share is a function of the refined model's numbers. Its variance is the sum, over the principal
axes of their covariance, of the squares of what one standard deviation along the axis does to it: the first order of
propagation, for which the game is played again with the refined model moved so.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import combinations

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, SimulationError
from harness.core.recording import Recording
from harness.diagnosis.attribution.reading import BASE, Reading, aligned, in_masses_of, mixed, moved, read_trace
from harness.diagnosis.attribution.restarted import Restarted, restarted
from harness.diagnosis.explain.engines import Simulator, shown_by
from harness.diagnosis.fit.model_fit import Fit, whitened
from harness.diagnosis.parameters import with_values
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.simulated import observe
from harness.kernels.solve import Scales
from harness.model.model import Model

ENGINE, PARAMETERS, TERMS = "engine", "parameters", "missing_physics"
MOST_SLIPPING = 1.0 / 3.0
"""Of the windows: where more are out of step within their period, squares say nothing of whose fault it is."""
_SEEN = 0.02
"""Share of the whole below which nothing is said."""

Value = Callable[[frozenset[str]], float]
"""What is left when these players have been put right; asked for the same players many times."""
Distance = Callable[[Model, bool], float]
"""How far a model is from the refined one; whether the user's engine simulates it."""
Nearby = Sequence[Sequence[Model]]
"""For each covariance the models one standard deviation along its axes; the larger error counts."""


def saved(players: Sequence[str], left: Value) -> Mapping[str, float]:
    """What putting each player right takes off what is left, averaged over all orders; sums to left({}) - left(all).

    Negative for a player whose error hides those of others.
    """
    count, found = len(players), dict.fromkeys(players, 0.0)
    for player in players:
        others = [other for other in players if other != player]
        for size in range(count):
            weight = math.factorial(size) * math.factorial(count - size - 1) / math.factorial(count)
            for before in map(frozenset, combinations(others, size)):
                found[player] += weight * (left(before) - left(before | {player}))
    return found


def nearby_of(found: Fit, matrices: Sequence[FloatArray]) -> Nearby:
    """Models beside a fit, for each covariance (q, q) of its numbers; what a recording does not tell stays as it is."""
    low, high = (np.array([getattr(f, end) for f in found.free]) for end in ("lower", "upper"))
    nearby = []
    for covariance in matrices:
        variance = np.diag(covariance)
        known = np.flatnonzero(np.isfinite(variance) & (variance > 0.0))
        scale = np.sqrt(variance[known])
        # steps whose squares sum to a covariance, of numbers of any units
        values, vectors = np.linalg.eigh(covariance[np.ix_(known, known)] / np.outer(scale, scale))
        steps = np.zeros((variance.size, known.size))
        steps[known] = scale[:, None] * vectors * np.sqrt(np.maximum(values, 0.0))
        beside = (np.minimum(np.maximum(found.values + step, low), high) for step in steps.T)
        nearby.append([with_values(found.model, found.free, one) for one in beside])
    return nearby


def errors_of(
    shares: Callable[[Model], Mapping[str, float]], found: Mapping[str, float], nearby: Nearby
) -> Mapping[str, float] | None:
    """Standard errors of shares that were found; None where nothing is nearby, or a model there cannot be played."""
    if not any(nearby):
        return None
    try:
        played = [[shares(model) for model in models] for models in nearby]
    except SimulationError:
        return None
    return {
        name: max(math.sqrt(sum((one[name] - value) ** 2 for one in models)) for models in played)
        for name, value in found.items()
    }


class NoSharesError(Exception):
    """Squares say nothing of whose the mismatch is; the text says why."""


@dataclass(frozen=True, slots=True)
class Attribution:
    """Shares of the whole, which sum to 1; a share below 0 belongs to an error that hides another.

    whole : mean square of the mismatch, in units of the noise. configured : the model of the simulation, as it was
    given or read. reading : of a trace. alone : what is left beyond the refined model when these alone are put right.
    by_parameter : distance from the refined model that each parameter of the simulation would bring by itself.
    shift : s by which a trace was moved in time. errors : standard errors of engine, parameters and missing_physics,
    from what the recording leaves open of the refined model; None where they were not looked for.
    """

    engine: float
    parameters: float
    missing_physics: float
    unexplained: float
    noise: float
    whole: float
    configured: Model
    alone: Mapping[str, float]
    by_parameter: Mapping[str, float]
    reading: Reading | None = None
    shift: float | None = None
    joined: bool = False
    errors: Mapping[str, float] | None = None

    def with_steps(self, left: float, refined: float) -> "Attribution":
        """The same where the recording is itself the trace of an engine, whose steps leave the mean square ``left``.

        refined : what the exact refined model leaves; what of it is above ``left`` is the integrator's, the engine's.
        """
        own = (refined - left) / self.whole
        return replace(self, engine=self.engine + own, unexplained=self.unexplained - own)

    @property
    def hides(self) -> bool:
        """Whether the parameters hide a missing term: put right alone, they make the match clearly worse."""
        before, after = self.alone[""], self.alone[PARAMETERS]
        return self.missing_physics > _SEEN and after > before + _SEEN * self.whole


def attribute_engine(
    simulate: Simulator, configured: Model, refined: Model, problem: Problem, scales: Scales, dt: float | None = None
) -> Attribution:
    """Attribution for an engine as it is configured: its settings, its step (s, None for the settings' own).

    configured : the user's model, else the baseline fit's. Raises SimulationError, NoSharesError where a third of the
    windows slip.
    """
    seen, user = restarted(refined, problem, scales), _user(configured, refined)
    as_configured = shown_by(simulate, user, seen.problem, dt)[0]
    _refuse_slips(seen, as_configured, "the simulation")

    def distance(model: Model, engine: bool) -> float:
        if not engine:
            return seen.distance(observe(model, seen.problem, scales=scales).y)
        return seen.distance(as_configured if model == user else shown_by(simulate, model, seen.problem, dt)[0])

    return _played((ENGINE, PARAMETERS, TERMS), distance, configured, refined, problem, scales)


def attribute_model(
    configured: Model, refined: Model, problem: Problem, scales: Scales, nearby: Nearby = ()
) -> Attribution:
    """Attribution for a model simulated exactly: no engine plays. nearby : models as likely as the refined one.

    Raises SimulationError, NoSharesError.
    """

    def played(refined: Model, seen: Restarted) -> Attribution:
        def distance(model: Model, engine: bool) -> float:
            return seen.distance(observe(model, seen.problem, scales=scales).y)

        return _played((PARAMETERS, TERMS), distance, configured, refined, problem, scales)

    return _with_errors(played, configured, "the model", refined, problem, scales, nearby)


def attribute_trace(
    trace: Recording,
    configured: Model | None,
    refined: Model,
    problem: Problem,
    scales: Scales,
    nearby: Nearby = (),
    whole: Problem | None = None,
) -> Attribution:
    """Attribution for a trace of the user's own simulation.

    configured : the model it was made with, None when it is not known; then what the trace tells of it, engine apart.
    Where it does not, what the trace reads stands for it, and engine and parameters are one share, ``parameters``.
    nearby : models as likely as the refined one. whole : the question at every sample of the recording, which the trace
    is laid over. Raises InputError for a trace that does not belong to the recording, NoSharesError for one that cannot
    be read or of which a third of the windows slip; SimulationError.
    """
    on = aligned(trace, problem, scales, whole)
    try:
        reading = read_trace(trace, problem, refined, on, configured)
    except InputError as error:
        raise NoSharesError(f"{trace.file} could not be read as the recording was: {error}") from None
    meant = configured if configured is not None or reading.adds is None else reading.adds.given
    joined = meant is None
    players = (PARAMETERS, TERMS) if joined else (ENGINE, PARAMETERS, TERMS)

    def played(refined: Model, seen: Restarted) -> Attribution:
        read = in_masses_of(reading.model, refined)

        def distance(model: Model, engine: bool) -> float:
            shown = model
            if engine and meant is not None:
                shown = moved(model, read, in_masses_of(meant, refined))
            left = reading.left if engine else 0.0
            return seen.distance(observe(shown, seen.problem, scales=scales).y) + left

        return _played(players, distance, read if meant is None else meant, refined, problem, scales, joined)

    found = _with_errors(played, reading.model, trace.file, refined, problem, scales, nearby)
    return replace(found, reading=reading, shift=on.clock.shift, joined=joined)


def _with_errors(
    played: Callable[[Model, Restarted], Attribution],
    start: Model,
    name: str,
    refined: Model,
    problem: Problem,
    scales: Scales,
    nearby: Nearby,
) -> Attribution:
    """A game played, and again at models nearby; start : what the simulation begins as, of this name."""

    def shares(model: Model) -> Mapping[str, float]:
        return _shares(played(model, restarted(model, problem, scales)))

    seen = restarted(refined, problem, scales)
    _refuse_slips(seen, observe(_user(start, refined), seen.problem, scales=scales).y, name)
    found = played(refined, seen)
    return replace(found, errors=errors_of(shares, _shares(found), nearby))


def _shares(found: Attribution) -> Mapping[str, float]:
    return {ENGINE: found.engine, PARAMETERS: found.parameters, TERMS: found.missing_physics}


def _user(configured: Model, refined: Model) -> Model:
    """The user's model with the refined one's start and zero."""
    own = in_masses_of(configured, refined)
    return mixed(own, own, refined)


def _refuse_slips(seen: Restarted, shown: Mapping[str, FloatArray], name: str) -> None:
    slipping = seen.slipping(dict(shown))
    if slipping > MOST_SLIPPING:
        raise NoSharesError(
            f"{name} is out of step with the recording within a period in {100.0 * slipping:.0f} % of the windows; "
            "one with about its frequency can be divided"
        )


def _played(
    players: tuple[str, ...],
    distance: Distance,
    configured: Model,
    refined: Model,
    problem: Problem,
    scales: Scales,
    joined: bool = False,
) -> Attribution:
    user, problem = _user(configured, refined), problem.followed

    @cache
    def left(put: frozenset[str]) -> float:
        parameters = refined if PARAMETERS in put else user
        terms = refined if TERMS in put else user
        # where the two are one share, the engine goes with the parameters
        engine = PARAMETERS not in put if joined else ENGINE in players and ENGINE not in put
        if not engine and parameters is refined and terms is refined:
            return 0.0
        return distance(mixed(parameters, terms, refined), engine)

    shares, shown = saved(players, left), observe(refined, problem, scales=scales).y
    values = whitened(problem, {c: y - shown[c] for c, y in problem.channels.items()})
    remaining = float(values @ values) / problem.points
    whole = max(left(frozenset()) + remaining, 1e-300)
    return Attribution(
        engine=shares.get(ENGINE, 0.0) / whole,
        parameters=shares[PARAMETERS] / whole,
        missing_physics=shares[TERMS] / whole,
        unexplained=(remaining - 1.0) / whole,
        noise=1.0 / whole,
        whole=whole,
        configured=user,
        alone={"": left(frozenset()), **{player: left(frozenset({player})) for player in players}},
        by_parameter={
            name: distance(replace(refined, **{name: getattr(user, name)}), False)
            for name in BASE
            if getattr(user, name) != getattr(refined, name)
        },
    )
