"""Recordings that cannot be diagnosed, refused with the reason; and units that look wrong, said in a sentence."""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording

FEWEST_HALF_CYCLES = 3
_SWING = 0.03
"""Smallest swing that counts as a half-cycle, as a share of the channel's range."""
_RAIL, _RAILS = 0.15, 0.6
"""Share of the samples at each end of a saturated channel's range, and at both together."""
_UNLIKE = 0.5
"""Correlation of a with the second derivative of x below which the two are of different motions."""
_SUSPECT = 3.0
"""Ratio of a to x'' from which a unit is doubted rather than a gain."""
_KNOWN = {
    1000.0: "a factor of 1000 (mm for m?)",
    9.80665: "standard gravity (g for m/s^2?)",
    57.29578: "degrees for rad?",
}
_NEAR = 1.15


def half_cycles(y: FloatArray, sigma: float) -> int:
    """Swings of a channel (n,) between turning points, those larger than 3 % of its range and than the noise."""
    swing = max(_SWING * float(np.ptp(y)), 6.0 * sigma)
    count, sign = 0, 0
    low = high = float(y[0])
    for value in y.tolist():
        if sign <= 0 and value > low + swing:
            count, sign, high = count + 1, 1, value
        elif sign >= 0 and value < high - swing:
            count, sign, low = count + 1, -1, value
        # while it rises only its top matters, and the other way round
        low, high = min(low, value), max(high, value)
    return count


def refuse(recording: Recording, sigma: dict[str, float]) -> None:
    """Raise InputError for what no diagnosis can be made of. sigma : noise by channel."""
    _refuse_saturated(recording)
    _refuse_mixed_units(recording)
    name = next(c for c in ("x", "v", "a") if c in recording)
    found = half_cycles(recording[name], sigma[name])
    if found < FEWEST_HALF_CYCLES:
        raise InputError(
            f"{recording.file}: channel {name}",
            f"{found} half-cycle{'' if found == 1 else 's'}",
            f"at least {FEWEST_HALF_CYCLES} are accepted",
        )


def _refuse_saturated(recording: Recording) -> None:
    for name in ("x", "v", "a"):
        if name not in recording:
            continue
        y = recording[name]
        low, high = float(np.mean(y == y.min())), float(np.mean(y == y.max()))
        if min(low, high) > _RAIL and low + high > _RAILS:
            found = (
                f"saturated throughout ({100.0 * (low + high):.0f} % of its samples at {y.min():.4g} or {y.max():.4g})"
            )
            raise InputError(
                f"{recording.file}: channel {name}", found, "a channel mostly within its range is accepted"
            )


def _refuse_mixed_units(recording: Recording) -> None:
    given = {c: recording.units[c] for c in ("x", "a") if recording.units.get(c)}
    if len(given) == 2:
        angles = {c: "rad" in unit or "deg" in unit or "°" in unit for c, unit in given.items()}
        if angles["x"] != angles["a"]:
            found = f"x in {given['x']} with a in {given['a']}, which cannot belong together"
            raise InputError(recording.file, found, "both as angles or both as lengths is accepted")


def compare_channels(recording: Recording, omega: float) -> str | None:
    """Hold a against the second derivative of x; a sentence when they differ by a factor like that of a wrong unit.

    omega : of the motion, rad/s. Raises InputError when the two are not of one motion.
    """
    if "x" not in recording or "a" not in recording:
        return None
    t = recording.t
    n = int(2 ** math.ceil(math.log2(max(256, min(recording.duration * omega * 16.0, 1 << 17)))))
    grid = np.linspace(t[0], t[-1], n)
    window = np.hanning(n)
    step = (grid[1] - grid[0]) if n > 1 else 1.0
    w = 2.0 * math.pi * np.fft.rfftfreq(2 * n, step)
    band = (w > 0.4 * omega) & (w < 2.5 * omega)
    x = np.fft.rfft((np.interp(grid, t, recording["x"]) - recording["x"].mean()) * window, 2 * n)[band]
    a = np.fft.rfft((np.interp(grid, t, recording["a"]) - recording["a"].mean()) * window, 2 * n)[band]
    curve = -(w[band] ** 2) * x
    size = float(np.linalg.norm(curve) * np.linalg.norm(a))
    if size == 0.0:
        return None
    full = np.zeros(w.size, dtype=np.complex128)
    full[band] = np.conj(curve) * a
    # in whatever time shift they agree best: a late sensor is no other motion
    likeness = float(np.max(np.abs(np.fft.irfft(full, 2 * n)))) * n / size
    if likeness < _UNLIKE:
        found = (
            f"x and a, which cannot belong together (a is like the second derivative of x to {100 * likeness:.0f} %)"
        )
        raise InputError(recording.file, found, "channels of one motion are accepted")
    ratio = float(np.linalg.norm(a) / np.linalg.norm(curve))
    if max(ratio, 1.0 / ratio) < _SUSPECT:
        return None
    factor = max(ratio, 1.0 / ratio)
    about = next((said for known, said in _KNOWN.items() if 1.0 / _NEAR < factor / known < _NEAR), "")
    times = f"{ratio:.4g} times" if ratio > 1.0 else f"1/{factor:.4g} of"
    suspect = f", {about}" if about else ""
    return f"acceleration does not match displacement: it is {times} what x implies{suspect}; check the units"
