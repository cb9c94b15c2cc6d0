"""How a recorded force acts between samples: smoothly, as straight lines, or held until the next as a controller's."""

import math
from contextlib import suppress
from dataclasses import dataclass, replace

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.diagnosis.baseline.base_fit import driven_scales, own_scales
from harness.diagnosis.fit.model_fit import Fit, fit, whitened
from harness.diagnosis.fit.observe import COARSE, observe
from harness.diagnosis.fit.parameters import free_of
from harness.diagnosis.input_noise.noisy_base_fit import in_turn
from harness.diagnosis.problems.driven import Driven
from harness.diagnosis.problems.starts import Windows
from harness.diagnosis.rules import FORCE_HELD
from harness.kernels.solve import Drive, Scales
from harness.model.model import Model

_ITERATIONS = 8
"""Of a first fit."""
_SAMPLES = 20_000
"""That tell whether a force is held, more than enough for a share of chi-square of 2 %."""
_STRAYS = 300.0
"""Standard deviations by which a simulation may miss on average; more, and it is another motion."""


ACTS_HELD = "the force acts as a sampled controller's, held from each sample to the next"


def held(t: FloatArray, u: FloatArray) -> Drive:
    """The drive of u (n,) at t (n,), s, when each value is held until the next."""
    return Drive(t, u, held=True)


@dataclass(frozen=True, slots=True)
class Acting:
    """How a force acts. otherwise : the other ways. held : until the next sample. follows : whether the base model,
    fitted to a first part, does so from one start. chi2 : that it leaves there.
    """

    drive: Drive
    otherwise: tuple[Drive, ...]
    held: bool
    follows: bool
    model: Model
    chi2: float


def acting(problem: Driven, u: FloatArray) -> Acting:
    """How the force u (n,) acts, and whether the base model then follows the recording.

    It acts as the samples themselves say where no other way lets the base model follow the recording better. The model
    strays where its misfit is hundreds of times what the sensor's noise is, as an encoder shows of a real drive, and
    where it cannot be simulated: then no law says the force well enough, and the force itself is what can be compared.
    """
    part, stepped, lines = problem.part(slice(0, _SAMPLES)), held(problem.t, u), Drive(problem.t, u)
    scales = driven_scales(problem, problem.first)

    def followed(drive: Drive) -> Fit | None:
        with suppress(SimulationError):
            return _followed(problem.first, replace(part, drive=drive), scales)
        return None

    usual, ways = followed(problem.drive), [stepped]
    if usual is None:
        return Acting(problem.drive, (), held=False, follows=False, model=problem.first, chi2=math.inf)
    if lines.t.size != problem.drive.t.size and _seen(lines, usual, part):
        ways.append(lines)
    fits = [(one, way) for way in ways if (one := followed(way)) is not None]
    found, drive = min(fits, key=lambda pair: pair[0].chi2, default=(usual, problem.drive))
    if found.chi2 >= FORCE_HELD.value * usual.chi2:
        found, drive = usual, problem.drive
    others = tuple(way for way in (problem.drive, *(way for _, way in fits)) if way is not drive)
    return Acting(drive, others, drive.held, found.chi2 < _STRAYS**2 * found.points, found.model, found.chi2)


def _seen(lines: Drive, usual: Fit, problem: Driven) -> bool:
    """Whether the noise lets the motion tell straight lines from what is usual, by as much as decides."""
    straight = replace(problem, drive=lines)
    try:
        shown = observe(usual.model, straight, (), own_scales(straight, usual.model), COARSE)
    except SimulationError:
        return False
    apart = whitened(problem, {c: y - usual.shown.y[c] for c, y in shown.y.items()})
    return float(apart @ apart) > (1.0 - FORCE_HELD.value) * usual.points


def _followed(model: Model, problem: Driven, scales: Scales) -> Fit:
    """The base model as it follows a drive; over gaps from starts of which nothing counts as known."""
    free = free_of(model, problem.base_names)

    def again(problem: Driven, found: Fit) -> tuple[Driven, Fit]:
        return problem, fit(found.model, problem, free, scales, _ITERATIONS, COARSE, thorough=False)

    found = fit(model, problem, free, scales, _ITERATIONS, COARSE, thorough=False)
    return in_turn(problem, found, scales, again)[1] if isinstance(problem.starts, Windows) else found
