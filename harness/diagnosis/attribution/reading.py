"""What a trace of the user's simulation reads: the same fit that the recording gets, to the trace.

Models with the parameters of one and the terms of another, released as a third: the coalitions of the game.
"""

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, SimulationError
from harness.core.events import Mode
from harness.core.recording import Recording
from harness.diagnosis.alignment.align import LEAST_SHARED, Alignment, align
from harness.diagnosis.alignment.match import DERIVED
from harness.diagnosis.baseline.base_fit import baseline, driven_baseline
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.integrator_maps import SOFT, Scheme, steps_of
from harness.diagnosis.parameters import free_of
from harness.diagnosis.pipeline import prepare
from harness.diagnosis.prepare.driven import is_driven
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.driven import Forced
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.problems.simulated import COARSE
from harness.diagnosis.request import Asked
from harness.diagnosis.sensor_model import channels_at
from harness.kernels.solve import Scales
from harness.model.model import Model, ModelTerm
from harness.model.term import Slot

_FORCES = ("N", "kg")
"""How units begin that hold a mass; parameters with them scale with it where only forces per unit mass are known."""


def in_masses_of(model: Model, other: Model) -> Model:
    """A model with its forces per the mass of ``other``, where one of the two masses is not known."""
    if model.m == other.m or (model.mass_known and other.mass_known):
        return model
    by = other.m / model.m
    f_s = None if model.f_s is None else by * model.f_s
    terms = tuple(_scaled(entry, by) for entry in model.terms)
    return replace(
        model, m=other.m, c=by * model.c, k=by * model.k, f_k=by * model.f_k, f_s=f_s, terms=terms,
        mass_known=other.mass_known,
    )  # fmt: skip


def _scaled(entry: ModelTerm, by: float) -> ModelTerm:
    parameters = entry.term.parameters
    values = [
        value * by if p.unit.split("/")[0].split(" ")[0] in _FORCES else value
        for p, value in zip(parameters, entry.values, strict=True)
    ]
    return replace(entry, values=tuple(values))


def mixed(parameters: Model, terms: Model, released: Model) -> Model:
    """Base parameters of one model and terms of another, with start and sensor's zero of a third."""
    return replace(
        parameters, terms=terms.terms, x0=released.x0, v0=released.v0, t0=released.t0, offset=released.offset
    )


BASE = ("m", "c", "k", "f_k")


def moved(model: Model, read: Model, meant: Model) -> Model:
    """A model whose parameters an engine shows as far off as it shows those it was given.

    read : what the engine's trace reads. meant : what it was given. The stiffness moves by a factor, the frictions by
    what is added; none falls below nothing.
    """
    return replace(
        model,
        k=model.k * read.k / meant.k if meant.k > 0.0 and read.k > 0.0 else model.k,
        c=max(0.0, model.c + read.c - meant.c),
        f_k=max(0.0, model.f_k + read.f_k - meant.f_k),
        f_s=None,
    )


_SHIPPED_LEAD = 0.0095
"""s: of MuJoCo's friction as shipped, 0.95 of half its time constant; where a fit begins."""
_FEWEST = 50
_MOST_SAMPLES = 12_000
"""Of a trace that is fitted; a finer one is thinned."""
_FINER = 0.03
"""Of the recording's noise, with which the last fit to a trace ends."""
_EVIDENCE = 10.0
"""By how much a trace's terms must better its BIC: those of a simulation are its own, and not its rounding's."""


@dataclass(frozen=True, slots=True)
class Adds:
    """What an engine adds to the model that it was given, read from a trace alone.

    given : that model, in the trace's masses. left : mean square that both leave, in units of the recording's noise.
    soft : the speed that friction is smoothed over and its lead, None where it turns round within a step. step (s),
    scheme : how the engine steps; None where its motion is as good as exact. others : the same motion by other schemes,
    which an acceleration would tell from it.
    """

    given: Model
    left: float
    soft: ModelTerm | None = None
    step: float | None = None
    scheme: Scheme | None = None
    others: tuple["Adds", ...] = ()


@dataclass(frozen=True, slots=True)
class Reading:
    """A trace of a simulation read as a model.

    found : the fit. left : mean square that the model leaves of the trace, in units
    of the recording's noise, the trace's own noise taken off: what the engine does that no parameter does. adds : what
    the engine adds to what it was given, None where that is not known.
    """

    found: Fit
    problem: Problem
    left: float
    adds: Adds | None = None

    @property
    def model(self) -> Model:
        """What the trace reads."""
        return self.found.model


def aligned(trace: Recording, problem: Problem, scales: Scales, whole: Problem | None = None) -> Alignment:
    """The trace laid over the recording; raises InputError for one that has nothing in common with it.

    whole : the question at every sample of the recording: what is left out of a fit, such as the wait before the
    release, tells where the two begin. covered : of the whole's samples, where it is given.
    """
    common = [c for c in problem.channels if c in trace]
    if not common:
        found = f"channels {', '.join(trace.channels)}"
        raise InputError(trace.file, found, f"one or more of {', '.join(problem.channels)}")
    span = float(problem.t[-1] - problem.t[0])
    if trace.duration < LEAST_SHARED * span:
        found = f"{trace.duration:.4g} s long"
        raise InputError(trace.file, found, f"a trace of at least half of the recording's {span:.4g} s")
    over = problem if whole is None else whole
    names = {c: over.channels[c] for c in common}
    seen = replace(over, channels=names, weight={c: over.weight[c] for c in common})
    return align(trace, seen, {c: problem.noise[c] for c in common}, 2.0 * math.pi / scales.omega)


def read_trace(
    trace: Recording, problem: Problem, refined: Model, on: Alignment, given: Model | None = None
) -> Reading:
    """Fit the base model to the trace, and the refined model's terms beside it where the trace asks for them.

    given : the model the trace was made with, whose terms are then kept as they are. Raises InputError for a trace that
    shows no motion to fit, SimulationError.
    """
    own = _prepared(trace, problem, on)
    base, scales = driven_baseline(own) if isinstance(own, Forced) else baseline(own)
    best = base
    if given is not None:
        best = _from(base, given, own, scales, with_terms=False) or base
    elif base.chi2 > base.points:
        dynamic = tuple(e for e in refined.terms if e.term.slot not in (Slot.OBSERVATION, Slot.EVENT))
        terms = _from(base, refined.with_terms(*dynamic), own, scales, with_terms=True) if dynamic else None
        if terms is not None and terms.bic < base.bic - _EVIDENCE:
            best = terms
    sharp, known = _sharpened(best, own, scales), tuple({id(one): one for one in (base, best)}.values())
    adds = None if refined.find(SOFT) else _added(known, sharp, _prepared(trace, problem, on, every=True), scales)
    if adds is not None and given is None and not adds.given.terms and best is not base:
        # the terms that the trace seemed to have stood for the engine's friction
        best, sharp = base, _sharpened(base, own, scales)
    return Reading(sharp, own, max(0.0, best.chi2 / best.points - 1.0), adds)


def _added(known: Sequence[Fit], sharp: Fit, every: Problem, scales: Scales) -> Adds | None:
    """What an engine adds to a model of the trace; None where no engine we know of explains the trace to the noise.

    known : fits to the trace without it. sharp : the best of them under a finer noise. every : the trace with all of
    its channels.
    """
    if sharp.chi2 <= sharp.points:
        # an exact motion: whatever its engine adds hides in the parameters
        return None
    finer, interval = _finer(every), float(np.median(np.diff(every.t)))
    tried, start = [], known[0].model
    for plain in known:
        own, level = plain.model, plain.model.f_k / plain.model.m
        softs = [
            ModelTerm.named(SOFT, v_r=lead * level, lead=lead) for lead in (_SHIPPED_LEAD, interval) if level > 0.0
        ]
        smooth = [_from(plain, own.with_terms(*own.terms, soft), every, scales, with_terms=True) for soft in softs]
        sharpened = [_sharpened(one, every, scales) for one in smooth if one is not None]
        if sharpened:
            one = min(sharpened, key=lambda fit: fit.chi2)
            given = one.model.with_terms(*(e for e in one.model.terms if e.term.key != SOFT))
            tried.append(Adds(given, one.chi2 / one.points, one.model.find(SOFT)))
            start = start if own.terms else one.model
    for steps in steps_of(finer, start):
        soft = None if steps.within_a_step else steps.model.terms[0]
        tried.append(Adds(steps.model.with_terms(), steps.left, soft, steps.h, steps.scheme))
    least = min((one.left for one in tried), default=math.inf)
    if least * _FINER**2 > 1.0 or least > (sharp.chi2 - _EVIDENCE) / sharp.points:
        return None
    alike = [one for one in tried if (one.left - least) * finer.points < _EVIDENCE]
    best, *others = sorted(alike, key=_usual)
    return replace(best, left=best.left * _FINER**2, others=tuple(others))


def _usual(one: Adds) -> int:
    """Of readings that are alike: soft friction is MuJoCo's, whose Euler takes the damping at the end of the step."""
    first = "explicit" if one.soft is None else "damping-implicit"
    return 0 if one.scheme == first else 1 if one.scheme is None else 2


def _finer(own: Problem) -> Problem:
    return replace(own, noise={c: replace(n, sigma=_FINER * n.sigma) for c, n in own.noise.items()})


def _from(base: Fit, meant: Model, own: Problem, scales: Scales, with_terms: bool) -> Fit | None:
    """The best fit with the terms of ``meant``, from the base fit's parameters, from its own, and from between.

    with_terms : whether the terms' parameters are fitted too.
    """
    read = base.model
    like = in_masses_of(meant, read)
    like = replace(like, m=read.m, x0=read.x0, v0=read.v0, t0=read.t0, offset=read.offset, mass_known=read.mass_known)
    half = replace(like, c=0.5 * (read.c + like.c), f_k=0.5 * (read.f_k + like.f_k), k=read.k)
    thin = own.part(slice(None, None, max(1, own.t.size // 1500)))
    best: Fit | None = None
    for start in (like, half, replace(like, k=read.k), read.with_terms(*like.terms)):
        free = tuple(f for f in free_of(start, own.base_names) if with_terms or isinstance(f.by, str))
        with suppress(SimulationError):
            rough = fit(start, thin, free, scales, 20, COARSE, thorough=False)
            if best is None or rough.chi2 < best.chi2:
                best = rough
    if best is None:
        return None
    with suppress(SimulationError):
        return fit(best.model, own, best.free, scales)
    return None


def _sharpened(found: Fit, own: Problem, scales: Scales) -> Fit:
    """The same fit with a finer noise: a simulation says more of its parameters than the recording's noise shows."""
    finer, best = _finer(own), found
    # whether it comes to rest a swing earlier is a step in chi-square: what is before the last swing leads past it
    moving = np.flatnonzero(found.shown.mode != Mode.STICK)
    last = float(own.t[moving[-1]]) - 1.5 * math.pi / scales.omega if moving.size else float(own.t[-1])
    early = int(np.searchsorted(own.t, last))
    with suppress(SimulationError):
        if early >= _FEWEST and early < own.t.size:
            best = fit(best.model, finer.part(slice(0, early)), found.free, scales, thorough=False)
        tried = [fit(start, finer, found.free, scales, thorough=False) for start in (best.model, found.model)]
        return min(tried, key=lambda one: one.chi2)
    return best


def _prepared(trace: Recording, problem: Problem, on: Alignment, every: bool = False) -> Problem:
    """The trace as a problem of its own, its noise that of the recording where that is larger.

    every : with channels that the recording does not have, as precise as those it has.
    """
    derived = trace.extra.get(DERIVED)
    every = every or derived is not None
    names = [c for c in ("x", "v", "a") if c in trace and c != derived and (every or c in problem.channels)]
    channels = {c: trace[c] for c in (*names, *(["u"] if "u" in trace else []))}
    if problem.drive is not None and not is_driven(trace):
        # a simulation that was driven by the recorded force need not repeat it
        at = on.clock.onto(trace.t)
        channels["u"] = problem.drive.at(at)
    if problem.drive is None:
        channels.pop("u", None)
    step = max(1, len(trace) // _MOST_SAMPLES)
    seen = Recording(trace.t[::step], {c: y[::step] for c, y in channels.items()}, trace.file, angular=problem.angular)
    asked = Asked(problem.restoring, problem.zero_free, problem.mass, None)
    own, _ = prepare(seen, asked)
    own = own.followed if isinstance(own, InverseDynamics) else own
    precise = min(problem.noise[c].sigma / float(np.std(y)) for c, y in problem.channels.items())
    level = {c: problem.noise[c].sigma if c in problem.noise else precise * float(np.std(trace[c])) for c in names}
    noise = {c: replace(n, sigma=max(n.sigma, level[c]), phi=0.0) if c in level else n for c, n in own.noise.items()}
    return own.under_noise(noise)


def trace_channels(trace: Recording, problem: Problem, on: Alignment) -> dict[str, FloatArray]:
    """The trace's channels (n,) at the recording's times, nan where it shows nothing."""
    names = [c for c in problem.channels if c in trace]
    at = on.clock.back(problem.t)
    shown = channels_at(trace, np.clip(at, trace.t[0], trace.t[-1]), names)
    return {c: np.where(on.covered, y, np.nan) for c, y in shown.items()}
