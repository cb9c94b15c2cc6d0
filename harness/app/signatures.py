"""What two traces of one motion differ by where an engine, not the physics, is the reason: compare's signatures.

Each is a figure that differs by a number which engines and their importers put there: 180/pi, no friction at all, a
damping of .04 or .05 of the links, a damping ratio of h omega/2, half a step.
"""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from harness.core.quantity import Quantity
from harness.core.recording import Recording
from harness.diagnosis.alignment.align import GIVEN
from harness.diagnosis.comparison import Comparison
from harness.results.common import P
from harness.results.compare import Reading, SignatureResult

_DEGREES = 180.0 / math.pi
_NEAR, _SURE = 3.0, 5.0
"""Standard errors within which a number is met, and by which two figures differ."""
_ALIKE = 0.005
"""Of a frequency and of friction, to which two motions are the same but for the damping."""
_NONE = 0.02
"""Of a friction, to which another must be known to be none beside it."""
_ROUND = 0.02
"""Of a number that a step makes: terms of a higher order in it."""
_SHIPPED = (1.0 / 240.0, 0.002)
"""s: steps of PyBullet and of MuJoCo where nobody sets one."""
_LINK, _BODY = 0.04, 0.05
"""1/s: what PyBullet damps links by, and PhysX the turning of bodies, where nobody says otherwise."""
_TURNS = 6
"""Turning points, at least, from which two dampings are told."""


def signatures(
    names: Sequence[str],
    readings: tuple[Reading, Reading],
    traces: tuple[Recording, Recording],
    comparison: Comparison,
) -> list[SignatureResult]:
    """Signatures in two traces of one motion, none of two that are the same within their noise.

    names, readings, traces : of the first and second.
    """
    if comparison.verdict != "different":
        return []
    found = [*_units(names, readings, traces[0].angular), *_no_friction(names, readings)]
    if not found:
        found = [*_links(names, readings, traces[0].angular)] or [*_damping(names, readings, traces[0])]
    return [*found, *_half_step(names[0], traces[0], comparison)]


def _values(p: P) -> tuple[float, float] | None:
    return None if p.value is None or not p.stderr else (p.value, p.stderr)


def _rate(one: Reading) -> tuple[float, float] | None:
    """Damping over inertia, 2 zeta omega, 1/s, and its error."""
    zeta, omega = _values(one.zeta), _values(one.omega_n)
    return None if zeta is None or omega is None else (2.0 * zeta[0] * omega[0], 2.0 * zeta[1] * omega[0])


def _signature(name: str, sentence: str, value: float, error: float, unit: str, expected: float) -> SignatureResult:
    own = Quantity(value, error, unit)
    return SignatureResult.model_validate(
        {"name": name, "sentence": sentence.format(own), "found": P.of(own), "expected": expected}
    )


def _units(names: Sequence[str], readings: tuple[Reading, Reading], angular: bool) -> Iterator[SignatureResult]:
    """Damping or stiffness that is 180/pi times the other's: per degree read per radian, or the other way round."""
    if not angular:
        return
    stiffness = [_values(one.omega_n) for one in readings]
    squared = [None if one is None else (one[0] ** 2, 2.0 * one[0] * one[1]) for one in stiffness]
    rates = [_rate(one) for one in readings]
    for what, pair in {"damping": rates, "stiffness": squared}.items():
        one, other = pair
        if one is None or other is None or min(one[0], other[0]) <= 0.0:
            continue
        for a, b, who, whose in ((one, other, names[0], names[1]), (other, one, names[1], names[0])):
            times = a[0] / b[0]
            error = times * math.hypot(a[1] / a[0], b[1] / b[0])
            if error < 0.1 * times and abs(times - _DEGREES) < max(_NEAR * error, _ROUND * _DEGREES):
                yield _signature(
                    "per-degree",
                    f"{who} has {{}} times the {what} of {whose}, and 180/pi is 57.296: one of them takes per degree"
                    " what the other takes per radian (harness words MODEL says which word)",
                    times, error, "1", _DEGREES,
                )  # fmt: skip


def _no_friction(names: Sequence[str], readings: tuple[Reading, Reading]) -> Iterator[SignatureResult]:
    """No dry friction at all where the other has some: the word was dropped."""
    pair = [_values(one.x_k) for one in readings]
    for (a, b), (who, whose) in ((pair, names), (pair[::-1], (names[1], names[0]))):
        if a is None or b is None or b[0] < 2.0 * _SURE * b[1]:
            continue
        if abs(a[0]) < _NEAR * a[1] and a[1] < _NONE * b[0]:
            unit = readings[0].x_k.unit
            yield _signature(
                "no-friction",
                f"{who} has no dry friction, x_k {{}} against {b[0]:.4g} {unit} in {whose}: its engine dropped the"
                " word, or the file has none (harness words MODEL says which engines do)",
                *a, unit, 0.0,
            )  # fmt: skip


def _links(names: Sequence[str], readings: tuple[Reading, Reading], angular: bool) -> Iterator[SignatureResult]:
    """PyBullet's damping of links, .04 (1 + |v|) 1/s, from what each half-swing of the first loses beyond the second's.

    Of an angle the part in the square has a length in it: it is looked for between none and one metre.
    """
    zeta, x_k, omega = (_values(getattr(readings[1], name)) for name in ("zeta", "x_k", "omega_n"))
    own = _values(readings[0].omega_n)
    turns = np.array([one.value for one in readings[0].events if one.value is not None and one.kind == "reversal"])
    if zeta is None or x_k is None or omega is None or own is None or turns.size < _TURNS:
        return
    if abs(own[0] / omega[0] - 1.0) > _ALIKE:
        return
    swing = 0.5 * np.abs(np.diff(turns))
    mean = np.sqrt(swing[:-1] * swing[1:])  # for which both laws hold exactly, one at a time
    lost = swing[:-1] - swing[1:] - 2.0 * math.sinh(0.5 * math.pi * zeta[0]) * mean - 2.0 * x_k[0]
    columns = np.column_stack((mean * 0.5 * math.pi / omega[0], 4.0 / 3.0 * np.square(mean)))
    (linear, square), left, *_ = np.linalg.lstsq(columns, lost, rcond=None)
    if not left.size:
        return
    errors = np.sqrt(np.diag(np.linalg.inv(columns.T @ columns)) * left[0] / (lost.size - 2))
    near = abs(linear - _LINK) < max(_NEAR * errors[0], 0.05 * _LINK) and errors[0] < 0.1 * _LINK
    least, most = (0.0, _LINK) if angular else (0.9 * _LINK, 1.1 * _LINK)
    if near and square > _NEAR * errors[1] and least - _NEAR * errors[1] < square < most + _NEAR * errors[1]:
        yield _signature(
            "link-damping",
            f"{names[0]} is damped by {{}} more than {names[1]}, and more so the faster it goes: PyBullet damps links"
            " by .04 (1 + |v|) 1/s where nobody sets linearDamping and angularDamping to 0; no physics",
            float(linear), float(errors[0]), "1/s", _LINK,
        )  # fmt: skip


def _damping(names: Sequence[str], readings: tuple[Reading, Reading], sim: Recording) -> Iterator[SignatureResult]:
    """A damping of the first beside the second's that engines add of their own, where all else is alike."""
    one, other = (_rate(reading) for reading in readings)
    if one is None or other is None or not _alike(readings):
        return
    more, error = one[0] - other[0], math.hypot(one[1], other[1])
    if abs(more) < _SURE * error:
        return
    omega = readings[0].omega_n.value or 0.0
    bullets = "the {:.3g} 1/s of Bullet's linearDamping and angularDamping where nobody sets them to 0"
    known: list[tuple[float, str, str]] = [(_LINK, "link-damping", bullets)]
    if sim.angular:
        known.append((_BODY, "body-damping", "the {:.3g} 1/s of PhysX's angularDamping where nobody sets it to 0"))
    for h in dict.fromkeys((sim.interval, *_SHIPPED)):
        expected = math.copysign(h * omega**2, more)  # of zeta h omega/2
        how = "takes its spring at the end of a step" if more > 0.0 else "moves before it takes its spring"
        off_by = f"zeta off by {0.5 * h * omega:.3g}, h omega/2"
        said = f"h omega^2 ({off_by}) at a step of {h:.4g} s, of an integrator that {how}"
        known.append((expected, "step-damping", said))
    off = {
        abs(more - expected) / within: (name, said, expected)
        for expected, name, said in known
        if error < 0.1 * abs(expected) and (within := max(_NEAR * error, _ROUND * abs(expected)))
    }
    if off and min(off) < 1.0:
        name, said, expected = off[min(off)]
        sentence = f"{names[0]} is damped by {{}} more than {names[1]}: that is {said.format(expected)}; no physics"
        yield _signature(name, sentence, more, error, "1/s", expected)


def _alike(readings: tuple[Reading, Reading]) -> bool:
    """Whether two motions have the same frequency and dry friction."""
    for name in ("omega_n", "x_k"):
        one, other = (_values(getattr(reading, name)) for reading in readings)
        if one is None or other is None:
            return False
        apart, error = abs(one[0] - other[0]), math.hypot(one[1], other[1])
        if apart > max(_NEAR * error, _ALIKE * max(abs(one[0]), abs(other[0]))):
            return False
    return True


def _half_step(name: str, sim: Recording, comparison: Comparison) -> Iterator[SignatureResult]:
    """Speed half a step beside position, as a semi-implicit step leaves them."""
    half = 0.5 * sim.interval
    shift = comparison.match.aligned.shift
    lags = [
        ("its velocity is {} beside its position", one.lag) for one in comparison.checks[0] if one.pair == ("x", "v")
    ]
    if shift.why != GIVEN and not lags:
        lags = [("it is {} beside the other", shift)]
    for what, lag in lags:
        if lag.value is None or not lag.stderr or lag.stderr > 0.1 * half:
            continue
        if abs(abs(lag.value) - half) < max(_NEAR * lag.stderr, _ROUND * half):
            yield _signature(
                "half-step",
                f"{name}: {what}, half of its sampling interval: so a semi-implicit step leaves them",
                lag.value, lag.stderr, "s", math.copysign(half, lag.value),
            )  # fmt: skip
