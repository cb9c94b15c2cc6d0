"""A driven recording made ready: noise, the drive between samples and over gaps, from where the motion is followed."""

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, SimulationError
from harness.core.recording import Recording
from harness.diagnosis.baseline.base_fit import driven_scales, own_scales
from harness.diagnosis.baseline.residual_noise import residual_noise
from harness.diagnosis.fit.fitted_states import begun
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.fit.standard_errors import unit_of
from harness.diagnosis.input_noise.noisy_base_fit import beyond_first_order
from harness.diagnosis.input_noise.propagation import between, force_noise, left_of, unlikely
from harness.diagnosis.parameters import free_of
from harness.diagnosis.prepare.felt import Felt, felt, unheard
from harness.diagnosis.prepare.held import held_driven, spring_beside
from harness.diagnosis.prepare.intersample import (
    ACTS_HELD,
    FAR_OFF,
    Acting,
    acting,
    between_samples,
    breaks_away,
    held,
    nearly,
)
from harness.diagnosis.problems.driven import Driven, Forced
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.problems.simulated import COARSE, observe
from harness.diagnosis.request import Asked
from harness.diagnosis.rules import DECISIVE, FORCE_HELD
from harness.diagnosis.smoothed_state.state import Course, inverse_start, told_by
from harness.diagnosis.starts import OneStart, Windows
from harness.estimate.noise import Noise, channel_noise, fine_noise, white_at_most, with_colour
from harness.estimate.readings import words
from harness.estimate.rest import quiet_at_rest
from harness.estimate.saturation import within_range
from harness.estimate.stray import stray_in
from harness.kernels.solve import Drive
from harness.model.model import Model, Restoring

ALL_FELT = "the scatter of the force is a controller's own, which the slider has felt: none of it is noise"
HANGS = "held by a pendulum: its motion comes nearer to the recorded one than a spring's"
HORIZON = 1.0
"""Default length of the windows where the force is fitted, s."""
_FEWEST_IN_WINDOW = 20
"""Samples: fewer say no more than where the window began."""
_UNKNOWN = 1e3
"""Standard errors of a smoothed start that stand for knowing nothing: the motion after it tells more."""
_MOVES = 1.5
"""Times its noise by which some channel of a driven slider must scatter."""


_ONE_WAY = 0.5
"""Share of its path by which a rotor ends elsewhere than it began: on a spring nothing does."""


def without_spring(recording: Recording, asked: Asked) -> tuple[Asked, tuple[str, ...]]:
    """What was asked of a driven recording, without a spring where a speed alone was recorded and goes on and on one
    way, and the sentence that says so.
    """
    if asked.restoring is not None or "x" in recording or "v" not in recording:
        return asked, ()
    v, dt = recording["v"], np.gradient(recording.t)
    if abs(float(v @ dt)) < _ONE_WAY * float(np.abs(v) @ dt):
        return asked, ()
    said = "It goes on one way, so that nothing pulls it back (--restoring none)."
    return replace(asked, restoring=Restoring.NONE), (said,)


def is_driven(recording: Recording) -> bool:
    """Whether a measured force acts."""
    return "u" in recording and bool(np.any(recording["u"] != 0.0))


def driven_problem(recording: Recording, asked: Asked) -> tuple[Forced, tuple[str, ...]]:
    """A driven recording as a problem, and what was done to it, one sentence each.

    It is followed from one start, over gaps from a new one. Where no force that is known says its motion well enough,
    or where covariates act, the force is fitted instead. Raises InputError, SimulationError.
    """
    # a speed that is commanded to stay at its limit is no sensor's
    seen, beyond = within_range(recording, ("x",))
    problem, course, stray = _seen(seen, asked)
    found, notes = _followed(problem, course, seen["u"], asked)
    return found, (*notes, *beyond, *stray)


def forced_problem(recording: Recording, asked: Asked) -> tuple[InverseDynamics, tuple[str, ...]]:
    """A driven recording whose force is fitted, whether or not its motion could be followed; see ``driven_problem``."""
    seen, beyond = within_range(recording, ("x",))
    problem, course, stray = _seen(seen, asked)
    found, notes = _by_force(problem, asked, course)
    return found, (*notes, *beyond, *stray)


def _seen(recording: Recording, asked: Asked) -> tuple[Driven, Course, tuple[str, ...]]:
    """The question without a choice of how it is fitted, the smoothed course, and what was done, one sentence each."""
    restoring = asked.restoring or Restoring.SPRING
    where = f"{recording.file}: channels {', '.join(recording.channels)}"
    if "x" not in recording and "v" not in recording:
        raise InputError(
            where, "a driven recording whose state cannot be seen", "x (or v with --restoring none) beside u"
        )
    if "x" not in recording and restoring is not Restoring.NONE:
        raise InputError(where, "a driven speed without a position; if nothing pulls it back", "try: --restoring none")
    t, u = recording.t, recording["u"]
    if float(np.ptp(u)) == 0.0:
        raise InputError(f"{recording.file}: channel u", f"the constant {u[0]:g}", "a force that changes")
    interval = recording.interval
    if asked.horizon is not None and asked.horizon < _FEWEST_IN_WINDOW * interval:
        found = f"{asked.horizon:g} s, {asked.horizon / interval:.1f} samples of {recording.file}"
        raise InputError("--horizon", found, f"at least {_FEWEST_IN_WINDOW * interval:g} s")
    channels: dict[str, FloatArray] = {c: recording[c] for c in ("x", "v", "a") if c in recording}
    stray, said = stray_in(recording, ("x", "v"))
    for c, off in stray.items():
        # what the neighbours say, without weight, so that samples stay evenly spaced
        channels[c] = channels[c] - off
    noise = _noise(t, channels, channel_noise)
    if all(float(np.std(y)) < _MOVES * noise[c].sigma for c, y in channels.items()):
        seen = ", ".join(f"{c} to {noise[c].sigma:.3g}" for c in channels)
        raise InputError(where, f"a slider that does not move beyond its noise ({seen})", "a driven motion")
    course = Course.of(t, channels, noise)
    unsaid = asked.restoring is None
    # beside a speed of its own x is not what the other slopes are of
    alike = "x" in channels and "v" not in channels
    state, force = told_by(t, channels["x"], u, course.state) if alike else (course.state, u)
    asked, held = held_driven(asked, state, force, recording.angular) if "x" in channels else (asked, ())
    restoring = asked.restoring or Restoring.SPRING
    first = inverse_start(state, force, restoring, asked.mass, bool(asked.zero_free))
    k, share, unsaid_spring = spring_beside(state, force, asked.mass)
    if restoring is Restoring.NONE and unsaid_spring:
        spring = f"a spring of {k:.3g} {'N m/rad' if recording.angular else 'N/m'}"
        took = f"takes {100.0 * share:.3g} % off what is left of the force"
        said = (*said, f"{spring} {took}: --restoring spring has it")
    x, v, _ = course.state
    drive, other = between_samples(t, u, course.longest)
    first = replace(first, x0=float(x[0]) - first.offset, v0=float(v[0]), t0=float(t[0]))
    gaps = float(np.max(np.diff(t))) > course.longest
    problem = Driven(
        t,
        channels,
        noise,
        weight={c: np.where(stray.get(c, 0.0) == 0.0, words(y), 0.0) for c, y in channels.items()},
        drive=drive,
        otherwise=(other,),
        mass=asked.mass,
        restoring=restoring,
        zero_free=bool(asked.zero_free) and restoring is not Restoring.NONE,
        angular=recording.angular,
        first=first,
        guarded=asked.guarded,
        pulled=(Restoring.PENDULUM,) if unsaid and recording.angular and restoring is Restoring.SPRING else (),
        starts=course.anew(math.inf) if gaps else OneStart(),
    )
    return problem, course, (*held, *said)


def _noise(
    t: FloatArray, channels: Mapping[str, FloatArray], white: Callable[[FloatArray, FloatArray], Noise]
) -> dict[str, Noise]:
    """Of each channel, with its colour. white : the usual one, by which a motion is smoothed, or the fine one, by which
    it is followed.
    """
    return {c: with_colour(t, y, white(t, y)) for c, y in channels.items()}


def _followed(problem: Driven, course: Course, u: FloatArray, asked: Asked) -> tuple[Forced, tuple[str, ...]]:
    t, first = problem.t, problem.first
    if asked.covariates or asked.guarded:
        # a model without what covariates do follows nothing, and how the force acts between samples cannot be told
        return _by_force(problem, asked, course)
    smooth = problem.noise
    problem = replace(problem, noise=_noise(t, problem.channels, fine_noise))
    told = _felt_of(problem, course, u)
    noise_u = _unfelt(channel_noise(t, u, rests=True), told, u)
    quiet = _quiet(problem, u, noise_u, course.longest)
    if np.any(quiet != u):
        problem, u = problem.less(Drive(t, u - quiet)), quiet
    if isinstance(problem.starts, Windows):
        # a first model without mass cannot be followed, nor does it say what noise does
        with suppress(SimulationError):
            problem = _allowing(problem, first, noise_u)
    acts = None if told is None else told.held
    force = acting(problem, u, acts)
    hangs: tuple[str, ...] = ()
    for other in problem.pulled:
        otherwise = problem.pulled_by(other)
        if (follows := acting(otherwise, u, acts)).chi2 < FORCE_HELD.value * force.chi2:
            problem, force, hangs = otherwise, follows, (HANGS,)
    unheld = problem.drive, *problem.otherwise
    problem = replace(problem, drive=force.drive, otherwise=force.otherwise)
    horizon = asked.horizon
    lost = not force.follows or _blurred(problem, force, noise_u)
    forced = _instead(replace(problem, noise=smooth), course, horizon or HORIZON) if lost else None
    if forced is not None and not _breaks_away(problem, force, forced[0]):
        return forced[0], (forced[1], *hangs, *([ACTS_HELD] if force.held else []))
    if horizon is not None:
        problem = replace(problem, starts=course.anew(horizon))
    problem = begun(problem, force.model, driven_scales(problem, force.model))
    problem, on_noise = _under_its_noise(problem, force, unheld, noise_u)
    notes = (*hangs, *on_noise)
    if not isinstance(problem.starts, Windows):
        return problem, ("driven: the whole recording is followed from one start", *notes)
    where = "between gaps of the recording" if horizon is None else f"of at most {horizon:g} s"
    how = f"the recording is followed over {_said(problem.starts)} {where}, each from a start of its own"
    return problem, (f"driven: {how}", *notes)


def _under_its_noise(
    problem: Driven, force: Acting, unheld: Sequence[Drive], noise: Noise
) -> tuple[Driven, tuple[str, ...]]:
    """The problem with what noise of its force does, if the slider has not felt that, and a sentence of it.

    unheld : in which ways it acts that is not held.
    """
    allowed = _allowing(problem, force.model, noise)
    if force.held and _felt(problem.as_recorded, allowed, force.model):
        return problem.as_recorded, (ALL_FELT,)
    if not force.held:
        allowed = _as_it_bends(allowed, unheld, force.model, noise)
    if allowed.force_noise is None or not allowed.force_noise.noise.found:
        return allowed.as_recorded, ()
    level = allowed.force_noise.noise.sigma
    share = 100.0 * level / math.sqrt(float(np.mean(allowed.drive.u**2)))
    of = f"{level:.3g} {unit_of('N', problem)} ({share:.2g} % of its rms)"
    averaged = "" if problem.scatter is None else "; where the slider rests it is averaged"
    return allowed, (f"the force's own noise, {of}, shows in the motion and is allowed for{averaged}",)


def _felt_of(problem: Driven, course: Course, u: FloatArray) -> Felt | None:
    """What a position, if that is recorded, has felt of the force u (n,), N, as its motion between reversals tells.

    Where friction is most of the force a rough inertia is off by a factor, and a short rest is smoothed over: a base
    model that follows the motion tells both.
    """
    if "x" not in problem.channels:
        return None
    found = nearly(problem)
    if found is not None:
        course = course.where(np.sign(found.shown.v))
    base = problem.first if found is None else found.model
    t, x, ways = problem.t, problem.channels["x"], (held(problem.t, u), problem.drive, *problem.otherwise)
    told, most = felt(t, x, problem.noise["x"], course, base, ways), unheard(t, u, x, course)
    if most is None:
        return told
    return Felt(most, None) if told is None else replace(told, level=min(told.level, most))


def _unfelt(noise: Noise, told: Felt | None, u: FloatArray) -> Noise:
    """The noise of a force u (n,), no more of it than the motion has not felt.

    Of a slider that turns every few samples, whose motion does not say, no more than a spectrum has room for.
    """
    level = told.level if told is not None else math.inf if noise.phi else white_at_most(u)
    if not noise.found or level >= noise.sigma:
        return noise
    return replace(noise, sigma=level, found=True) if level > 0.0 else replace(noise, found=False)


def _instead(problem: Driven, course: Course, horizon: float) -> tuple[InverseDynamics, str] | None:
    """The force, as it was recorded, to be fitted, and the sentence; None where no motion lasts enough samples."""
    windows = course.anew(horizon)
    forced = InverseDynamics.of(problem.as_recorded, windows)
    how = f"the force is fitted, and simulations run over {_said(windows)} of at most {horizon:g} s, each"
    with suppress(SimulationError):
        # asked for here, as it is what needs samples
        forced.measured  # noqa: B018
        return forced, f"driven: {how} restarted from the smoothed recorded state"
    return None


def _blurred(problem: Driven, force: Acting, noise: Noise) -> bool:
    """Whether what noise of its force does to a motion that is far from the recorded one is no longer told by partials.

    Beyond first order it leaves more of a chi-square than that scatters by chance: reversals then come at other times.
    """
    if force.chi2 < FAR_OFF**2 * problem.points:
        return False
    allowed, scales = _allowing(problem, force.model, noise), driven_scales(problem, force.model)
    noisy = allowed.force_noise
    if noisy is None or not noisy.noise.found:
        return False
    found = fit(force.model, allowed, free_of(force.model, problem.base_names), scales)
    return beyond_first_order(found, allowed, noisy, scales) > math.sqrt(2.0 * allowed.points)


def _breaks_away(problem: Driven, force: Acting, forced: InverseDynamics) -> bool:
    """Whether it is followed where what it withstands at rest, which is more than its sliding friction, holds it."""
    f_s = float(np.max(np.abs(forced.measured.held(problem.first)), initial=0.0))
    return f_s > problem.first.f_k and breaks_away(problem, force, f_s)


def _quiet(problem: Driven, u: FloatArray, noise: Noise, longest: float) -> FloatArray:
    """A force (n,), N, without its noise where the slider's position, if that is recorded, rests."""
    if "x" not in problem.channels:
        return u
    return quiet_at_rest(problem.t, problem.channels["x"], u, problem.noise["x"], noise, longest)


def _by_force(problem: Driven, asked: Asked, course: Course) -> tuple[InverseDynamics, tuple[str, ...]]:
    """Fitted by its force, in which it shows how covariates enter."""
    windows, names = course.anew(asked.horizon or HORIZON), ", ".join(one.name for one in asked.covariates)
    why, and_given = (f", as {names} acts too,", f" and given {names}") if names else (",", "")
    how = (
        f"the force is fitted{why} and simulations run over {_said(windows)} of at most {asked.horizon or HORIZON:g} s"
    )
    note = f"driven: {how}, each restarted from the smoothed recorded state{and_given}"
    return InverseDynamics.of(problem, windows), (note,)


def by_its_force(problem: Driven) -> InverseDynamics:
    """A recording that was to be followed, fitted by its force, as that acts in it."""
    smooth = replace(problem, noise=_noise(problem.t, problem.channels, channel_noise))
    return InverseDynamics.of(smooth, Course.of(smooth.t, smooth.channels, smooth.noise).anew(HORIZON))


def _said(windows: Windows) -> str:
    return f"{len(windows.windows)} window{'s' if len(windows.windows) > 1 else ''}"


def _allowing(problem: Driven, model: Model, noise: Noise) -> Driven:
    """The problem under the noise of its force if that shows in a model's motion, and for starts that are not known."""
    shown = observe(model, problem, (), own_scales(problem, model), COARSE)
    starts = None
    if isinstance(problem.starts, Windows):
        # standard deviations of the starts of windows, as if next to nothing was known of them
        starts = np.zeros((problem.t.size, 2))
        for w in problem.starts.windows:
            starts[w.start] = _UNKNOWN * w.x_sd, _UNKNOWN * w.v_sd
    unknown = problem.unknown * between(problem, noise)
    force = force_noise(model, shown, problem.t, noise, problem.noise, starts, drive=problem.drive, between=unknown)
    return replace(problem, force_noise=force)


def _as_it_bends(problem: Driven, ways: Sequence[Drive], model: Model, noise: Noise) -> Driven:
    """The problem under the noise of its force, if that shows, acting smoothly unless straight is decidedly likelier.

    Straight lines predict a noisy force better, and lie inside of what bends: as a little less inertia, which came out
    .3 % too small where the motion could not tell the two.
    """
    if problem.force_noise is None:
        return problem
    known = problem.drive, *problem.otherwise
    each = (replace(problem, drive=way, otherwise=tuple(one for one in known if one is not way)) for way in ways)
    straight, smooth = sorted((_allowing(one, model, noise) for one in each), key=lambda one: one.drive.t.size)
    return straight if _unlikely(straight, model) < _unlikely(smooth, model) - DECISIVE.value else smooth


def _felt(problem: Driven, allowed: Driven, model: Model) -> bool:
    """Whether a held force acts as it is recorded, so that no part of its scatter is noise.

    A controller's command scatters with its encoder. The motion tells: under the force as it stands the sensors' noise,
    of the level that is left within short windows, is decidedly more likely than under a noisy one.
    """
    noisy = allowed.force_noise
    if noisy is None or not noisy.noise.found or isinstance(problem.starts, Windows):
        return False
    found, own, left = _left_noise(problem, model)
    as_it_stands = unlikely(found, replace(problem, noise=own))
    return as_it_stands < unlikely(found, replace(allowed, noise=allowed.own_noise(own, left))) - DECISIVE.value


def _unlikely(problem: Driven, model: Model) -> float:
    """Minus twice the log-likelihood of the base fit, from a model on, under the noise that it leaves."""
    found, own, left = _left_noise(problem, model)
    return unlikely(found, replace(problem, noise=problem.own_noise(own, left)))


def _left_noise(problem: Driven, model: Model) -> tuple[Fit, dict[str, Noise], dict[str, FloatArray]]:
    """The base fit from a model on, the noise of each channel that it leaves, and what it leaves (n,)."""
    scales = driven_scales(problem, model)
    found = fit(model, problem, free_of(model, problem.base_names), scales)
    left, period = left_of(problem, found.shown), 2.0 * math.pi / scales.omega
    own = {c: residual_noise(problem.t, left[c], y, period, problem.noise[c]) for c, y in problem.channels.items()}
    return found, own, left
