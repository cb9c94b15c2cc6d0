"""The base fit of a free decay: viscous and Coulomb friction on the restoring force, without falling into false minima.

The number of half-cycles before the slider sticks jumps with f_k, and a phase that slips by a cycle has a minimum of
its own. So the start comes from the spectrum and the envelope, from several shares of viscous and dry friction, and
the fit first sees the swing's amplitude and phase. Where no phase can be followed so, it sees the first cycles only and
then ever more of the recording. The best is kept.

The base fit of a driven recording, which its inverse dynamics start.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, SimulationError
from harness.diagnosis.covariates.following import enter
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.fit.swing_fit import Swing, swung
from harness.diagnosis.motion import motion_of
from harness.diagnosis.parameters import base_of, free_of, with_values
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.driven import Forced
from harness.diagnosis.problems.simulated import COARSE
from harness.fit.series import peaks
from harness.kernels.solve import Scales
from harness.model.elsewhere import Elsewhere, parted
from harness.model.model import Model

_SHARES = (0.5, 0.15, 0.85)
"""Of the damping that is given to dry friction at a start; the best fit of the three goes on."""
_CLEARLY_MOVING = 6.0
"""Standard errors of the first speed from which a release from rest need not be tried."""
_FINER, _LEAST_PERIODS = 4, 1.25
"""Lines of a spectrum to a period over the recording, and the least periods of a swing: three half-cycles are accepted,
and a peak is as wide as a quarter of a period."""
_FIRST_CYCLES, _FEWEST = 2.0, 24
"""Cycles of the first stretch that is fitted, each next one twice as long; its samples: four to each of six numbers."""
_FEWEST_AMPLITUDES = 8
"""Samples from which two amplitudes and a mean are read."""
_THIN = 1500
"""Samples of a rough fit."""
_TRIED = 3
"""Recordings whose own fits are starts of a common one, beside the mean of all."""
_MANY_CYCLES = 20.0
"""A phase that is off by a hundredth, as a spectrum gives it, has then slipped by a radian."""
_WHOLE = 0.75
"""Of the samples that a cycle has, from which it shows its size: both its turning points lie in any so many."""
_ABOVE_NOISE = 0.15
"""Of the first peak: smaller ones may be noise or rest, and do not count for the decay that a fit starts from."""


def dominant_frequency(t: FloatArray, y: FloatArray) -> float:
    """Angular frequency (rad/s) at which a channel (n,) swings, from its spectrum's peak."""
    n = max(256, min(2 * t.size, 1 << 16))
    grid = np.linspace(t[0], t[-1], n)
    even = np.interp(grid, t, y)
    even = (even - even.mean()) * np.hanning(n)
    power = np.abs(np.fft.rfft(even, _FINER * n)) ** 2
    step = 2.0 * math.pi / (_FINER * n * (grid[1] - grid[0]))
    # a rest off the mean has its peak at no frequency at all: what swings is a peak beyond it
    tops = peaks(power)
    swings = tops[tops > _FINER * _LEAST_PERIODS]
    i = int(swings[0]) if swings.size else int(np.argmax(power[1:])) + 1
    if i + 1 < power.size:
        left, mid, right = np.log(power[i - 1 : i + 2] + 1e-300)
        bend = left - 2.0 * mid + right
        shift = 0.5 * (left - right) / bend if bend < 0.0 else 0.0
        return float((i + shift) * step)
    return float(i * step)


def _decay(t: FloatArray, y: FloatArray, omega: float) -> float:
    """Relative loss of amplitude per radian over the recording: an effective damping ratio."""
    cycle = 2.0 * math.pi / omega
    edges = np.searchsorted(t, np.arange(t[0], t[-1], cycle))[:-1]
    # a cycle of which a gap holds a part shows less than its size
    whole = np.flatnonzero(np.diff(edges) >= _WHOLE * np.max(np.diff(edges), initial=1))
    each = np.array([float(np.ptp(y[edges[k] : edges[k + 1]])) for k in whole])
    seen = each > _ABOVE_NOISE * each[:1]
    if np.count_nonzero(seen) < 2:
        return 0.05
    slope = np.polyfit(whole[seen], np.log(each[seen]), 1)[0]
    return float(min(max(-slope / (2.0 * math.pi), 1e-4), 0.5))


def scales_of(problem: Problem, omega: float) -> Scales:
    """What counts as ordinary in this recording."""
    name, power = next((c, n) for c, n in (("x", 0), ("a", 2), ("v", 1)) if c in problem.channels)
    x = float(np.max(np.abs(problem.channels[name]))) / omega**power
    return Scales(x, x * omega, omega)


def starts(problem: Problem) -> list[Model]:
    """Base models to start from, made from spectrum and envelope."""
    name = next(c for c in ("x", "v", "a") if c in problem.channels)
    t, y = problem.t, problem.channels[name]
    omega = dominant_frequency(t, y)
    if not math.isfinite(omega) or omega <= 0.0:
        raise InputError("recording", "nothing that swings", "a free decay")
    # amplitudes over the first cycle
    keep = t - t[0] <= 2.0 * math.pi / omega
    if np.count_nonzero(keep) < _FEWEST_AMPLITUDES:
        keep = np.arange(t.size) < _FEWEST_AMPLITUDES
    phase = omega * (t[keep] - t[0])
    basis = np.column_stack((np.cos(phase), np.sin(phase), np.ones(phase.size)))
    cosine, sine, _ = np.linalg.lstsq(basis, y[keep], rcond=None)[0].tolist()
    x0, v0 = {
        "x": (cosine, sine * omega),
        "v": (-sine / omega, cosine),
        "a": (-cosine / omega**2, -sine / omega),
    }[name]
    loss = _decay(t, y, omega)
    m = problem.mass or 1.0
    amplitude = math.hypot(x0, v0 / omega)
    # equal energy over a cycle at half the first amplitude: 4 f_k X = pi c omega X^2
    models = []
    for share in _SHARES:
        zeta = loss * (1.0 - share)
        f_k = share * loss * m * omega**2 * 0.5 * amplitude * math.pi / 2.0
        models.append(
            Model(
                m, 2.0 * zeta * omega * m, m * omega**2, f_k, x0=x0, v0=v0, t0=float(t[0]),
                restoring=problem.restoring, mass_known=problem.mass is not None,
            )
        )  # fmt: skip
    return models


def _grow(model: Model, problem: Problem, scales: Scales) -> Fit:
    """Fit ever longer stretches, so that the phase never slips."""
    free, t = free_of(model, problem.base_names), problem.t
    span, cycle = float(t[-1] - t[0]), 2.0 * math.pi / scales.omega
    cycles = _FIRST_CYCLES
    while cycles * cycle < span:
        stop = int(np.searchsorted(t, t[0] + cycles * cycle))
        if stop >= _FEWEST:
            part = problem.part(slice(0, stop, max(1, stop // _THIN)))
            model = fit(model, part, free, scales, 12, COARSE, thorough=False).model
        cycles *= 2.0
    return fit(model, problem, free, scales, thorough=False)


def _whole(model: Model, problem: Problem, scales: Scales, swing: Swing | None = None) -> Fit:
    """Fit the whole recording at once, right where the spectrum gave the frequency well; its swing first, if given."""
    free = free_of(model, problem.base_names)
    rough = problem.part(slice(None, None, max(1, problem.t.size // _THIN))) if swing is None else swing.problem
    model = model if swing is None else swung(model, swing, free, scales)
    found = fit(model, rough, free, scales, 15, COARSE, thorough=False)
    return fit(found.model, problem, free, scales, thorough=False)


def _attempts(models: Sequence[Model], problem: Problem, scales: Scales) -> Iterator[Callable[[], Fit]]:
    """What is tried from several starts.

    In few cycles it is when the slider sticks that parts minima: a knock, too, ends the growing fit in one of its own,
    and the whole at once has others. In many it is the phase, which a swing does not lose.
    """
    swing = Swing.of(problem, scales.omega)
    if swing is not None:
        yield from (partial(_whole, model, problem, scales, swing) for model in models)
        if problem.duration * scales.omega > 2.0 * math.pi * _MANY_CYCLES:
            yield partial(_grow, models[0], problem, scales)
            return
    for model in models:
        yield partial(_grow, model, problem, scales)
        yield partial(_whole, model, problem, scales)


def baseline(problem: Problem) -> tuple[Fit, Scales]:
    """The best fit of the base model, and of what covariates do, to a free decay.

    Raises InputError when the recording does not swing or a covariate says nothing of its own, SimulationError when no
    start could be simulated.
    """
    if problem.alone:
        return _of_several(problem, [baseline(one) for one in problem.alone])
    models = problem.rough or starts(problem)
    scales = problem.scales or scales_of(problem, math.sqrt(models[0].k / models[0].m))
    best = _best(_attempts(models, problem, scales))
    best = _with_care(best, replace(problem, acting=()), scales)
    return (enter(best, problem, scales).fit if problem.acting else best), scales


def _best(attempts: Iterable[Callable[[], Fit]], worth: Callable[[Fit], float] = lambda found: found.chi2) -> Fit:
    """The best of several rough fits. Raises SimulationError when none could be simulated."""
    best: Fit | None = None
    why = ""
    for attempt in attempts:
        try:
            found = attempt()
        except SimulationError as error:
            why = str(error)
            continue
        if best is None or worth(found) < worth(best):
            best = found
    if best is None:
        raise SimulationError(f"no base fit could be simulated: {why}")
    return best


def _with_care(found: Fit, problem: Problem, scales: Scales) -> Fit:
    return at_rest(fit(found.model, problem, found.free, scales), problem, scales)


def _of_several(problem: Problem, alone: Sequence[tuple[Fit, Scales]]) -> tuple[Fit, Scales]:
    """One base model of several recordings, from what each says alone; their starts and zeros stay their own."""
    models = [one.model for one, _ in alone]
    own = problem.own_names
    elsewhere = tuple(Elsewhere(tuple((name, float(getattr(m, name))) for name in own)) for m in models[1:])
    if "m" in own:
        # alone each is per unit of its own mass
        heavier = [m.m * models[0].k / m.k if m.k > 0.0 else m.m for m in models[1:]]
        elsewhere = tuple(one.having(m=mass) for one, mass in zip(elsewhere, heavier, strict=True))
    starts = {name: float(getattr(models[0], name)) for name in own}
    names = problem.physics
    of_all = tuple(sum(getattr(m, name) for m in models) / len(models) for name in names)
    tries = dict.fromkeys([of_all, *(tuple(float(getattr(m, name)) for name in names) for m in models[:_TRIED])])
    scales = problem.scales or scales_of(problem, float(np.median([s.omega for _, s in alone])))
    begun = ({**dict(zip(names, physics, strict=True)), **starts, "t0": models[0].t0} for physics in tries)
    attempts = (partial(_whole, replace(models[0], **one, elsewhere=elsewhere), problem, scales) for one in begun)
    return _with_care(_best(attempts), problem, scales), scales


def at_rest(found: Fit, problem: Problem, scales: Scales) -> Fit:
    """The same fit released from rest, where the recording does not ask for a speed at its start."""
    for name in (name for name in base_of(found.free) if parted(name)[0] == "v0"):
        at = next(i for i, f in enumerate(found.free) if f.name == name)
        error = math.sqrt(max(float(found.covariance()[at, at]), 0.0)) * math.sqrt(max(1.0, found.chi2 / found.points))
        if abs(found.values[at]) > _CLEARLY_MOVING * error:
            continue
        model = with_values(found.model, (found.free[at],), np.zeros(1))
        with suppress(SimulationError):
            still = fit(model, problem, free_of(model, tuple(n for n in base_of(found.free) if n != name)), scales)
            found = still if still.bic <= found.bic else found
    return found


_AT_ONCE = 1e3
"""Times faster than the motion: so fast answers a slider whose mass no force shows, and its time says nothing."""
_DRY = (1.0, 0.5, 1.5)
"""Shares of the dry friction that the inverse dynamics give, from which a driven fit starts."""


def driven_baseline(problem: Forced) -> tuple[Fit, Scales]:
    """The base model fitted to a driven recording, from the inverse dynamics and from less and more dry friction.

    Raises SimulationError when no start could be simulated.
    """
    model, scales = problem.first, driven_scales(problem, problem.first)
    names = problem.base_names
    # smoothing rounds off a first motion out of rest, so that a start at rest is looked at too
    still = tuple(name for name in names if name != "v0")
    begun = ((0.0, still), (model.v0, names)) if "v0" in names else ((model.v0, names),)

    def begin(share: float, v0: float, base: tuple[str, ...]) -> Fit:
        started = replace(model, f_k=share * model.f_k, v0=v0)
        return fit(started, problem, free_of(started, base), scales, thorough=False)

    attempts = (partial(begin, share, *start) for share, start in product(_DRY, begun))
    return _best(attempts, lambda found: found.bic), scales


def driven_scales(problem: Problem, model: Model) -> Scales:
    """What counts as ordinary in a driven recording; without a spring omega is the motion's own."""
    if problem.alone:
        each = [driven_scales(one, model) for one in problem.alone]
        omega = float(np.exp(np.mean([math.log(one.omega) for one in each])))
        return Scales(max(one.x for one in each), max(one.v for one in each), omega)
    omega = math.sqrt(model.k / model.m)
    cycle = omega or dominant_frequency(problem.t, next(iter(problem.channels.values())))
    motion = motion_of(problem.t, problem.channels, cycle)
    if omega == 0.0:
        omega = math.sqrt(float(np.mean(motion.v**2))) / max(float(np.std(motion.x)), 1e-300)
    return Scales(0.5 * float(np.ptp(motion.x)), float(np.max(np.abs(motion.v))), omega)


def own_scales(problem: Problem, model: Model) -> Scales:
    """A model's own under the drive; those of the motion where the model has next to no mass."""
    own, seen = Scales.of(model, problem.drive), driven_scales(problem, model)
    return own if own.omega < _AT_ONCE * seen.omega else seen
