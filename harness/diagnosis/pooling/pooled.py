"""Recordings pooled, as far as they can be: what differs is each one's own, and is said."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

import numpy as np

from harness.core.quantity import Quantity
from harness.core.recording import MINIMUM_SAMPLES
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.standard_errors import covariances
from harness.diagnosis.pooling.own import SAID, Compared, Freed, alone, compared, freed
from harness.diagnosis.problems.forces_together import ForcesTogether
from harness.diagnosis.problems.together import Together
from harness.diagnosis.residual_tests.structure import Left, left_by
from harness.diagnosis.rules import DECISIVE, OWN, POOLED
from harness.diagnosis.search.extend import extend, settle
from harness.diagnosis.search.search import Search, noise_of, under
from harness.kernels.solve import Scales
from harness.model.elsewhere import named
from harness.model.model import Model

S = TypeVar("S", bound=Together | ForcesTogether)

MOST = 2
"""Parameters that may differ; where more do, it is another machine."""
_SHOWN = 2.0
"""Standard errors from which a recording is said to differ from the first."""


@dataclass(frozen=True, slots=True)
class Pooled(Generic[S]):
    """Recordings that share all but ``own``. problem : under the noise that the base leaves. base : its fit."""

    problem: S
    base: Fit
    scales: Scales
    compared: Compared

    @property
    def own(self) -> tuple[str, ...]:
        """Base parameters that differ."""
        return self.problem.starts.own

    @property
    def differs_in(self) -> str:
        """What these are called; "" where all is shared."""
        return " and ".join(SAID[stem] for stem in self.own)


def _less(found: Pooled[Together], one: Freed) -> Pooled[Together]:
    """With one more parameter each recording's own."""
    problem = replace(one.problem, noise=noise_of(one.fit, one.problem, found.scales.omega))
    return replace(found, problem=problem, base=settle(under(one.fit, problem), problem, found.scales))


def models_of(seen: Compared) -> list[Model]:
    """The base model of each recording by itself."""
    return [one.fit.model for one in seen.alone]


def shared_by(problem: Together, base: Fit, scales: Scales) -> Pooled[Together]:
    """Recordings whose base parameters differ have one or two of their own, if that says more than the catalogue does.

    Where they do not differ by more than their errors, nothing is tried. What lets go of a slider is no part of it:
    where more than noise is left, only what follows the first turning points is looked at. Raises SimulationError.
    """
    seen = compared([alone(one) for one in problem.alone])
    problem = problem.under_levels([one.problem.noise for one in seen.alone])
    found = _seen(problem, base, scales, seen)
    if all(one.explained for one in seen.alone) or seen.chance >= POOLED.value:
        return _parted(found)
    later, left_out = problem.of_hand_free(MINIMUM_SAMPLES)
    if left_out == 0.0:
        return _parted(found)
    again = compared([alone(one) for one in later.alone])
    own = _parted(_seen(later, *baseline(later), again)).own
    found = replace(found, compared=again)
    for stem in own:
        each = freed(found.base, found.problem, scales, models_of(again))
        found = _less(found, next(one for one in each if one.stem == stem))
    return found


def _seen(problem: Together, base: Fit, scales: Scales, seen: Compared) -> Pooled[Together]:
    """Under the noise that the base leaves."""
    problem = replace(problem, noise=noise_of(base, problem, scales.omega))
    return Pooled(problem, settle(under(base, problem), problem, scales), scales, seen)


def _parted(found: Pooled[Together]) -> Pooled[Together]:
    scales, seen = found.scales, found.compared
    if seen.chance >= POOLED.value:
        return found
    while len(found.own) < MOST and left_by(found.base, found.problem, scales.omega, found.base) is Left.STRUCTURE:
        best = _first(freed(found.base, found.problem, scales, models_of(seen)))
        if best is None:
            break
        laws = extend(found.base, found.problem, scales).fits
        # a law that says as much leaves one machine, which is the simpler thing to say
        if laws and laws[0].bic < best.fit.bic + DECISIVE.value:
            break
        found = _less(found, best)
    return found


def unmasked(found: Search, before: Pooled[Together]) -> Pooled[Together] | None:
    """Recordings with one more parameter of their own, where one shows beside the law that explains the rest."""
    if len(before.own) >= MOST or not found.explained:
        return None
    problem, scales, best = found.problem, before.scales, found.chosen
    assert isinstance(problem, Together)
    one = _first(freed(best, problem, scales))
    if one is None or one.fit.bic > best.bic - DECISIVE.value:
        return None
    base = _first(freed(before.base, before.problem, scales, models_of(before.compared)), one.stem)
    return None if base is None else _less(before, base)


def _first(each: Sequence[Freed], stem: str | None = None) -> Freed | None:
    """The one with most evidence, if it has enough; the one of that name, whatever it has."""
    if stem is not None:
        return next((one for one in each if one.stem == stem), None)
    enough = [one for one in each if one.gain >= OWN.value]
    return enough[0] if enough else None


@dataclass(frozen=True, slots=True)
class Differs:
    """A base parameter of a recording over that of the first."""

    stem: str
    ratio: Quantity

    @property
    def clearly(self) -> bool:
        """Whether it is another number, by its error."""
        value, error = self.ratio.value, self.ratio.stderr
        return value is not None and (error is None or abs(value - 1.0) > _SHOWN * error)

    def said(self, first: str) -> str:
        """As a sentence has it."""
        value, error = self.ratio.value or 1.0, self.ratio.stderr
        size = Quantity(100.0 * abs(value - 1.0), None if error is None else 100.0 * error, "%", self.ratio.why)
        return f"{SAID[self.stem]} {size} {'above' if value > 1.0 else 'below'} that of {first}"


def differences(found: Fit, problem: Together | ForcesTogether, omega: float, explained: bool) -> list[list[Differs]]:
    """What each recording has of its own beside start and zero, over the first's; omega of the swing, rad/s."""
    at = {f.name: i for i, f in enumerate(found.free)}
    matrices, values = covariances(found, problem, omega, explained), found.values
    every: list[list[Differs]] = [[]]
    for r in range(1, len(problem.starts.stretches)):
        row = []
        for stem in problem.starts.own:
            name = named(stem, r)
            first = float(getattr(found.model, stem))
            value = float(values[at[name]]) if name in at else first
            if first <= 0.0:
                row.append(Differs(stem, Quantity(None, None, "1", "there is none in the first")))
                continue
            gradient = np.zeros(values.size)
            if name in at:
                gradient[at[name]] = 1.0 / first
            if stem in at:
                gradient[at[stem]] = -value / first**2
            used = gradient != 0.0
            variance = max(float(gradient[used] @ m[np.ix_(used, used)] @ gradient[used]) for m in matrices)
            error = math.sqrt(variance) if math.isfinite(variance) and variance > 0.0 else None
            row.append(Differs(stem, Quantity(value / first, error, "1", None if error else "not determined")))
        every.append(row)
    return every
