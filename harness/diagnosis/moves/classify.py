"""The kind of a motion from its numbers alone, before any fit: harness.diagnosis.moves.kinds.

Where it stays counts, how it goes from place to place, and whether it does so at a steady speed.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.diagnosis.moves.falling import creeps, falls, falls_again, rises
from harness.diagnosis.moves.kinds import MotionKind, Moves
from harness.diagnosis.moves.series import FEWEST_HALF_CYCLES, Series, Swings
from harness.model.model import Restoring

_SHORT = 0.03
"""Of the time, after which noise about a level has forgotten where it was."""
_SPRING = 0.999
"""Correlation of a force with the position, from which it is that of the spring: a sensor's noise is below 4 %."""
_STAYS, _DIRECT = 0.35, 1.58
"""Share of the time at places, and way over distance between them, of what is sent there: what is let go swings on."""
_OR_NOT = ", as a sensor drifts (--restoring none reads it as a run-down)"
_HELD = 0.5
_LARGE, _COVERED = 0.15, 0.6
"""First half-swing of a decay, of the largest, and share of the way that decays take."""


def classify(recording: Recording, restoring: Restoring | None = None) -> Moves:
    """What a recording holds. restoring : what somebody says that pulls it back.

    One channel tells: x where there is one, else v, else a.
    """
    return replace(_classified(recording, restoring), current=recording.extra.get("current", ""))


def _classified(recording: Recording, restoring: Restoring | None) -> Moves:
    if recording.steady:
        return Moves(MotionKind.FRICTION_CURVE, "speeds that were held, with the forces that held them", forced=True)
    name = next(c for c in ("x", "v", "a") if c in recording)
    series = Series.of(recording.t, recording[name])
    if "u" in recording and np.any(recording["u"] != 0.0):
        return _forced(series, name)
    free = restoring in (None, Restoring.NONE) and name != "a"
    if free and (found := _one_way(recording, told="v" in recording or restoring is not None)) is not None:
        return found
    stays = {"x": _placed, "v": _levels}.get(name)
    return (
        _unsmooth(series)
        or (_drifts(series) if name == "x" and not (free and _turns(recording)) else None)
        or (None if stays is None else stays(series, free))
        or _swung(series)
    )


def _one_way(recording: Recording, told: bool) -> Moves | None:
    """What goes one way, slower and slower or faster and faster. told : whether it is no drift of a sensor for sure."""
    if spans := falls_again(recording):
        each = tuple((float(recording.t[first]), float(recording.t[last - 1])) for first, last in spans)
        return Moves(MotionKind.RUN_DOWN, f"{len(each)} times brought to speed and let go", each)
    if (span := falls(recording)) is not None:
        part = slice(*span)
        if not (told or _turns(recording)) and creeps(recording.t[part], recording["x"][part]):
            return Moves(MotionKind.NOT_MECHANICAL, f"no dry friction stops what creeps to a level{_OR_NOT}")
        ends = float(recording.t[span[0]]), float(recording.t[span[1] - 1])
        return Moves(MotionKind.RUN_DOWN, "its speed keeps one sign and falls", (ends,))
    return Moves(MotionKind.SPIN_UP, "its speed keeps one sign and rises") if rises(recording) else None


_FREE = (MotionKind.FREE_DECAY, MotionKind.SEVERAL_DECAYS, MotionKind.RUN_DOWN)


def without_idle_force(recording: Recording) -> Recording:
    """A recording without a force that is noise about a level while it swings or runs down, or that of its own spring:
    nothing drives it there.

    What noise shakes does not become smaller with each half-cycle.
    """
    if recording.steady or "u" not in recording or not np.ptp(recording["u"]):
        return recording
    force = Series.of(recording.t, recording["u"])
    if _is_of_a_spring(recording):
        like = "proportional to the position, as that of its own spring,"
    elif not force.smooth and force.memory <= _SHORT:
        like = f"noise about {float(np.mean(recording['u'])):.3g}"
    else:
        return recording
    column = recording.columns.get("u", "u")
    said = f"The force, {column}, is {like} while it moves freely: not used; u in --columns has it act."
    free = replace(
        recording,
        channels={name: values for name, values in recording.channels.items() if name != "u"},
        columns={name: product for name, product in recording.columns.items() if name != "u"},
        units={name: unit for name, unit in recording.units.items() if name != "u"},
        notes=(*recording.notes, said),
    )
    return free if classify(free).kind in _FREE else recording


def _is_of_a_spring(recording: Recording) -> bool:
    if "x" not in recording or not np.ptp(recording["x"]):
        return False
    return abs(float(np.corrcoef(recording["x"], recording["u"])[0, 1])) > _SPRING


def _forced(series: Series, name: str) -> Moves:
    if not series.smooth:
        return Moves(MotionKind.HELD, f"a force acts, and {name} does not move beyond its noise", forced=True)
    if name == "x" and steady(series):
        return Moves(MotionKind.SLOW_AXIS, "a force acts, and it goes at one speed between its turns", forced=True)
    return Moves(MotionKind.DRIVEN, "a force that was recorded acts", forced=True)


def _turns(recording: Recording) -> bool:
    """Whether an angle goes through more than a turn, as no sensor drifts."""
    return recording.angular and "x" in recording and float(np.ptp(recording["x"])) > 2.0 * np.pi


def _unsmooth(series: Series) -> Moves | None:
    """What no mass does."""
    if series.jumps > 1:
        return Moves(MotionKind.NOT_MECHANICAL, f"{series.jumps} jumps within a sample")
    if series.smooth:
        return None
    if series.memory <= _SHORT:
        return Moves(MotionKind.AT_REST, "noise about a level, as large from sample to sample as over longer")
    return Moves(MotionKind.NOT_MECHANICAL, "too rough from sample to sample for a mass, at any level of noise")


def _drifts(series: Series) -> Moves | None:
    """What comes to a level as a sensor does."""
    if not relaxes(series):
        return None
    return Moves(MotionKind.NOT_MECHANICAL, f"an exponential towards a level{_OR_NOT}")


def _placed(series: Series, free: bool) -> Moves | None:
    """What goes from place to place, or at one speed, where nothing pulls it back."""
    if not free:
        return None
    if steady(series):
        return Moves(MotionKind.SLOW_AXIS, "one speed between its turns")
    places = Places.of(series)
    if places.detour >= _DIRECT or places.share < _STAYS:
        return None
    count, share = len(places.levels), f"{100.0 * places.share:.0f} % of the time"
    if count > 2:
        return Moves(MotionKind.STEPS, f"{share} at {count} places in turn, and straight from one to the next")
    return Moves(MotionKind.HELD, f"{share} at one place, to which it was brought") if places.share > _HELD else None


def _levels(series: Series, free: bool) -> Moves | None:
    """What goes from one speed to the next, as a motor that is switched."""
    places = Places.of(series)
    if not free or places.detour >= _DIRECT or places.share < _STAYS or len(places.levels) < 2:
        return None
    at = f"{100.0 * places.share:.0f} % of the time at {len(places.levels)} speeds"
    return Moves(MotionKind.STEPS, f"{at}, and straight from one to the next")


def _swung(series: Series) -> Moves:
    """Decays, or what goes on."""
    swings = Swings.of(series)
    count = len(swings)
    if count < FEWEST_HALF_CYCLES:
        few = f"{count} half-cycle{'' if count == 1 else 's'}, fewer than {FEWEST_HALF_CYCLES}"
        return Moves(MotionKind.NOT_MECHANICAL, few)
    decays = [one for one in swings.decays() if one.size[0] >= _LARGE * float(np.max(swings.size))]
    covered = sum(one.path for one in decays) / swings.path
    spans = tuple((float(one.begin[0]), float(one.end[-1])) for one in decays)
    if decays and covered >= _COVERED:
        first, last = decays[0].size[0], decays[0].size[-1]
        if len(decays) == 1:
            said = f"{len(decays[0])} half-cycles, from the first to the last {last / first:.2g} of its size"
            return Moves(MotionKind.FREE_DECAY, said, spans)
        if swings.broken >= len(decays) - 1:
            said = f"{len(decays)} times let go, and smaller with each half-cycle"
            return Moves(MotionKind.SEVERAL_DECAYS, said, spans)
    if not swings.even and len(swings) < 2 * FEWEST_HALF_CYCLES:
        return Moves(MotionKind.NOT_MECHANICAL, f"{count} half-cycles at uneven times")
    return Moves(MotionKind.DRIVEN, f"{count} half-cycles that do not become smaller one after another")


_BAND, _LONG = 0.1, 0.04
"""Of the range, within which something stays, and of the time, from which it does."""
_CREEPS = 0.25
"""Of that band, by which its last two thirds may differ: those of what passes through differ by a third of it."""
_AWAY, _TURNS = 0.15, 0.08
"""Of the range: how far apart two places are at least, and half-swings on the way between."""
_SLOW, _STEADY, _MOVING = 0.2, 0.27, 0.25
"""Of a usual speed, below which it turns or rests; how far speeds scatter; share of the time in which it moves."""
_TAUS = np.geomspace(0.03, 3.0, 40)
"""Of the time, in which something forgets where it came from."""
_LEFT = 0.012
"""Of the range, that an exponential leaves where it is what moved."""


@dataclass(frozen=True, slots=True)
class Places:
    """levels (k,) : where it stays, in turn. share : of the time.

    detour : way over distance, at its largest, of what lies between.
    """

    levels: tuple[float, ...]
    share: float
    detour: float

    @classmethod
    def of(cls, series: Series) -> "Places":
        """Of x."""
        y, span = series.y, series.span
        stays = _stays(series.lightly, _BAND * span, max(int(_LONG * y.size), 3))
        levels = [float(np.median(y[i:j])) for i, j in stays]
        share = sum(j - i for i, j in stays) / y.size
        # where it is first and last are places too
        first = [] if stays and stays[0][0] == 0 else [(0, 1)]
        last = [] if stays and stays[-1][1] == y.size else [(y.size - 1, y.size)]
        detour = 0.0
        for (_, j), (k, _) in pairwise([*first, *stays, *last]):
            way = float(np.ptp(y[j - 1 : k + 1]))
            if way >= _AWAY * span:
                detour = max(detour, Swings.of(series, _TURNS, slice(j - 1, k + 1)).path / way)
        return cls(tuple(levels), share, detour)


def _stays(y: FloatArray, band: float, least: int) -> list[tuple[int, int]]:
    """Stretches of y (n,) of ``least`` samples and more that stay within a band; those side by side at one place are
    one."""
    found, begin, low, high = list[tuple[int, int]](), 0, float(y[0]), float(y[0])
    for i, value in enumerate([*y.tolist(), np.inf]):
        lowest, highest = min(low, value), max(high, value)
        if highest - lowest <= band:
            low, high = lowest, highest
            continue
        third = (i - begin) // 3
        comes = abs(np.median(y[i - third : i]) - np.median(y[i - 2 * third : i - third])) if i > begin + 2 else band
        if i - begin >= least and comes < _CREEPS * band:
            before = found[-1] if found else (0, 0)
            alike = found and abs(np.median(y[slice(*before)]) - np.median(y[begin:i])) <= band
            near = alike and np.ptp(y[before[1] : begin + 1]) <= 2.0 * band
            found = [*found[:-1], (before[0], i)] if near else [*found, (begin, i)]
        begin, low, high = i, value, value
    return found


def steady(series: Series) -> bool:
    """Whether a place changes at one speed wherever it does, in both directions."""
    v = np.abs(np.gradient(series.lightly, series.t))
    usual = float(np.quantile(v, 0.9))
    moving = v > _SLOW * usual
    seen = v[moving]
    return bool(np.mean(moving) >= _MOVING and np.std(seen) <= _STEADY * np.mean(seen))


def relaxes(series: Series) -> bool:
    """Whether it is an exponential towards a level, from first to last."""
    s = (series.t - series.t[0]) / (series.t[-1] - series.t[0])
    y, least = series.y, np.inf
    for tau in _TAUS:
        table = np.column_stack((np.ones(s.size), np.exp(-s / tau)))
        least = min(least, float(np.std(y - table @ np.linalg.lstsq(table, y, rcond=None)[0])))
    return least < max(_LEFT * series.span, 2.0 * series.left)
