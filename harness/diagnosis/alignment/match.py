"""Two traces of any origin laid over each other: what differs, in units of the noise.

Two recordings held against each other measure one kind of thing: lengths, or angles.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.quantity import Quantity
from harness.core.recording import MINIMUM_SAMPLES, Recording
from harness.diagnosis.alignment.align import Alignment, align
from harness.diagnosis.alignment.pair import Clock, Pair
from harness.diagnosis.baseline.base_fit import dominant_frequency
from harness.estimate.noise import Noise, channel_noise
from harness.estimate.reversals import Kind, NoDecay, period_of

_OWN = {True: ("rad", "rad/s", "rad/s^2"), False: ("m", "m/s", "m/s^2")}
_KINDS = {"x": Kind.DISPLACEMENT, "v": Kind.VELOCITY, "a": Kind.ACCELERATION}
DERIVED = "derived"
"""Of a trace's ``extra``: the channel that is a derivative of another one, by which steps and friction are not read."""
_DROWNS = 0.05
"""Share of a derivative's scatter that may be what the digits of a trace make of it."""
_INSTANT = 1e-3
"""Share of a sampling interval by which instants that are the same may differ: times are written with few digits."""


def as_kind_of(one: Recording, other: Recording, option: str = "") -> Recording:
    """The first as what the second is: one whose file names no unit is read in rad, or in m, as the other.

    option : where the first was given, for the message. Raises InputError where one is a length and the other an angle.
    """
    if one.angular == other.angular:
        return one
    if _named(one):
        said = {True: "an angle", False: "a length"}
        where = f"{option} {one.file}" if option else one.file
        raise InputError(
            where,
            f"{said[one.angular]} ({_said(one)}), where {other.file} is {said[other.angular]} ({_said(other)})",
            "two traces of one kind; --columns says what a column is",
        )
    units = dict(zip("xva", _OWN[other.angular], strict=True))
    note = f"Its columns name no unit: read in {' and '.join(units[c] for c in 'xva' if c in one)}, as {other.file}."
    return replace(one, angular=other.angular, notes=(*one.notes, note))


def showing(trace: Recording, other: Recording) -> Recording:
    """A simulation's trace with what the other one shows: derivatives of its position or speed, where none is shared.

    As it is where it shares a channel, where it has none to derive from, and where its own digits would drown what is
    derived (more than ``_DROWNS`` of its scatter).
    """
    motion = tuple(_KINDS)
    if any(c in other and c in trace for c in motion):
        return trace
    last = next(i for i, c in enumerate(motion) if c in other)
    first = next((i for i in reversed(range(last)) if motion[i] in trace), None)
    if first is None:
        return trace
    wanted, from_ = motion[last], motion[first]
    derived = trace[from_]
    for _ in range(last - first):
        derived = np.gradient(derived, trace.t, edge_order=2)
    if channel_noise(trace.t, derived).sigma > _DROWNS * float(np.std(derived)):
        return trace
    note = f"It has no {wanted}: that is taken from its {from_}, by differences of neighbouring samples."
    extra = {**trace.extra, DERIVED: wanted}
    return replace(trace, channels={**trace.channels, wanted: derived}, extra=extra, notes=(*trace.notes, note))


def of_one_kind(one: Recording, other: Recording) -> tuple[Recording, Recording]:
    """Both as one kind; the one that names no unit gives way. Raises InputError where neither does."""
    if _named(one) and not _named(other):
        return one, as_kind_of(other, one)
    return as_kind_of(one, other), other


def _named(recording: Recording) -> bool:
    """Whether its file names a unit of the motion."""
    return any(recording.units.get(c) for c in ("x", "v", "a"))


def _said(recording: Recording) -> str:
    channel = next(c for c in ("x", "v", "a") if c in recording)
    unit = recording.units.get(channel) or _OWN[recording.angular]["xva".index(channel)]
    return f"{channel} in {unit}"


@dataclass(frozen=True, slots=True)
class Match:
    """real minus sim at shared times t (n,), s, of the real trace's clock.

    aligned : the shift, its error, and what else it could be. clock : as applied. sim, real : channels in common at t,
    difference : real - sim, SI. whitened : the same in units of the noise of both. partial : of whitened by the shift.
    noise : of the difference, by channel. found : noise of each trace, (sim, real). omega : rad/s of the swing.
    interpolated : whether one of the two had to be, so that samples next to a jump mean little. identical : whether
    the two hold the same samples there.
    """

    t: FloatArray
    aligned: Alignment
    clock: Clock
    sim: Mapping[str, FloatArray]
    real: Mapping[str, FloatArray]
    whitened: Mapping[str, FloatArray]
    partial: Mapping[str, FloatArray]
    noise: Mapping[str, Noise]
    found: tuple[Mapping[str, Noise], Mapping[str, Noise]]
    omega: float
    interpolated: bool
    identical: bool

    @property
    def difference(self) -> dict[str, FloatArray]:
        """Real minus sim by channel, SI units."""
        return {c: self.real[c] - self.sim[c] for c in self.real}


def swing_of(recording: Recording) -> float:
    """Angular frequency of a recording's motion, rad/s; raises InputError when it does not swing."""
    name = next(c for c in ("x", "v", "a") if c in recording)
    t, y = recording.t, recording[name]
    try:
        # a long wait before the release is no swing: of a displacement the speed is looked at
        return 2.0 * math.pi / period_of(t, y, _KINDS[name], channel_noise(t, y))
    except NoDecay:
        omega = dominant_frequency(t, y)
    if not math.isfinite(omega) or omega <= 0.0:
        raise InputError(recording.file, "nothing that swings", "a motion that swings")
    return omega


def match(sim: Recording, real: Recording, given: float | None = None) -> Match:
    """Lay a simulated trace over a recorded one.

    Times are those of the trace that is sampled less densely; the other is interpolated. given : a shift, s, that is
    taken as it is; None to find it, with the measured force of both too where there is one.

    Raises InputError when no channel is common, or too few samples are.
    """
    common = [c for c in ("x", "v", "a") if c in sim and c in real]
    if not common:
        raise InputError(
            f"{sim.file} and {real.file}",
            f"channels {', '.join(sim.channels)} and {', '.join(real.channels)}",
            "two traces with one of x, v, a in common",
        )
    omega = swing_of(real)
    period = 2.0 * math.pi / omega
    ours, theirs = ({c: channel_noise(one.t, one[c], period) for c in "xva" if c in one} for one in (sim, real))
    found = ours, theirs
    noise = {c: _both(ours[c], theirs[c]) for c in common}
    if "u" in sim and "u" in real and min(np.ptp(sim["u"]), np.ptp(real["u"])) > 0.0:
        forces = [channel_noise(one.t, one["u"], period, rests=True) for one in (sim, real)]
        aligned = align(sim, real, noise | {"u": _both(*forces)}, period, given)
    else:
        aligned = align(sim, real, noise, period, given)
    same = _same_samples(sim, real, aligned.clock)
    if same is not None and (given is None or abs(given - same[0]) < _INSTANT * real.interval):
        shift, here, there = same
        clock = Clock(shift, 1.0, float(sim.t[0]))
        exact, even = Quantity(shift, 0.0, "s"), Quantity(1.0, 0.0, "1")
        aligned = replace(aligned, shift=exact, scale=even, clock=clock, alternatives=())
        t, left, right = real.t[there], {c: sim[c][here] for c in common}, {c: real[c][there] for c in common}
    else:
        same, clock = None, aligned.clock
        t, left, right = Pair(sim, real, noise, period).at(clock)
    if t.size < MINIMUM_SAMPLES:
        raise InputError(
            f"{sim.file} and {real.file}",
            f"{t.size} samples at shared times",
            f"traces that overlap by at least {MINIMUM_SAMPLES} samples",
        )
    frozen = MappingProxyType
    return Match(
        t,
        aligned,
        clock,
        frozen(left),
        frozen(right),
        frozen({c: noise[c].whitened(right[c] - left[c]) for c in common}),
        frozen({c: noise[c].whitened(np.gradient(left[c], t)) for c in common}),
        noise,
        found,
        omega,
        interpolated=same is None and not (clock == Clock(0.0, 1.0, clock.origin) and t.size == len(sim) == len(real)),
        identical=same is not None,
    )


def _same_samples(sim: Recording, real: Recording, clock: Clock) -> tuple[float, slice, slice] | None:
    """The exact shift, s, and the samples of each, where two hold the same values at the same instants, one for one;
    None where they do not.
    """
    begin = int(np.argmin(np.abs(real.t - sim.t[0] - clock.shift)))
    ahead = int(np.argmin(np.abs(sim.t + clock.shift - real.t[0]))) if begin == 0 else 0
    count = min(len(sim) - ahead, len(real) - begin)
    ours, theirs = slice(ahead, ahead + count), slice(begin, begin + count)
    if count < MINIMUM_SAMPLES:
        return None
    # a shift of whole digits, as the one who moved the clock wrote it
    shift = float(np.round(float(np.median(real.t[theirs] - sim.t[ours])), 9))
    together = np.max(np.abs(real.t[theirs] - sim.t[ours] - shift)) <= _INSTANT * real.interval
    alike = together and all(np.array_equal(sim[c][ours], real[c][theirs]) for c in sim.channels if c in real)
    return (shift, ours, theirs) if alike else None


def _both(a: Noise, b: Noise) -> Noise:
    """Noise of a difference."""
    variance = a.sigma**2 + b.sigma**2
    phi = (a.phi * a.sigma**2 + b.phi * b.sigma**2) / variance
    return Noise(math.sqrt(variance), a.found or b.found, phi, max(a.step, b.step))
