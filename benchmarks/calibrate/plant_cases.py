"""Random free decays of the plant as the search sees them: problem, noise, base fit, the true effect alone on it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.core.errors import SimulationError
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.search.extend import extend, settle
from harness.diagnosis.search.long_recordings import shortened
from harness.diagnosis.search.search import noise_of, under
from harness.estimate.noise import channel_noise
from harness.kernels.solve import Scales
from harness.model.registry import NAMED
from harness.model.term import Term
from harness.proof.plant.cases import Case, draw
from harness.proof.plant.effects import BENCH, KINDS, compatible

NOISES = ("white", "coloured", "quantised")
NAMES = tuple(name for name in KINDS if any(term.name == name and "driven" not in term.needs for term in NAMED))
"""Effects of the plant that show in a free decay."""


@dataclass(frozen=True, slots=True)
class Start:
    """A recording before its search. base : fit under the noise as it leaves it."""

    problem: Problem
    base: Fit
    scales: Scales


def case_of(names: str | tuple[str, ...], rng: np.random.Generator, index: int) -> Case:
    """A free decay with these effects, the style of its noise in turn. Raises SimulationError where none comes out."""
    found = draw(names, rng, noise=NOISES[index % len(NOISES)])
    if found.base.drive is not None:
        raise SimulationError(f"plant: {names} is driven")
    return found


def pair_of(rng: np.random.Generator, among: Sequence[str] = NAMES) -> tuple[str, str]:
    """Two effects that can act together, one of them of ``among``, seen without a channel that the other forbids."""
    while True:
        first, second = str(rng.choice(list(among))), str(rng.choice(list(NAMES)))
        if compatible(first, second) and len({BENCH[name].needs for name in (first, second)} - {""}) < 2:
            return first, second


def start_of(case: Case) -> Start:
    """The recording of a case, made ready. Raises SimulationError when its base model cannot be fitted."""
    t, channels = case.recorded["t"], {c: case.recorded[c] for c in case.channels}
    problem = FreeDecay(t, channels, {c: channel_noise(t, y) for c, y in channels.items()})
    problem, base, scales = shortened(problem)
    return seen(problem, base, scales)


def seen(problem: Problem, fitted: Fit, scales: Scales) -> Start:
    """The noise as a fit leaves it, and the fit settled under it."""
    problem = replace(problem, noise=noise_of(fitted, problem, scales.omega))
    return Start(problem, settle(under(fitted, problem), problem, scales), scales)


def terms_of(name: str) -> tuple[Term, ...]:
    """Catalogue entries of a name."""
    return tuple(term for term in NAMED if term.name == name)


def with_term(start: Start, name: str) -> Start | None:
    """The base and this name's best law, noise as it leaves it, as ``base`` of what follows; None where none fits."""
    fits = extend(start.base, start.problem, start.scales, terms_of(name)).fits
    return seen(start.problem, fits[0], start.scales) if fits else None
