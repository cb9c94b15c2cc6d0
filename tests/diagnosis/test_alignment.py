"""Time alignment: a known shift with an honest error, a recording against itself, and lengths never against angles."""

import re
from dataclasses import dataclass

import numpy as np
import pytest

from harness.api import compare
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.alignment.align import align
from harness.diagnosis.alignment.match import as_kind_of, of_one_kind
from harness.estimate.noise import Noise
from harness.kernels.solve import solve
from harness.model.model import Model

DECAY = Model(1.0, 0.12, 100.0, 0.3, x0=0.1)
PERIOD = 2.0 * np.pi / 10.0
NOISE = {"x": Noise(1e-4, True), "a": Noise(3e-2, True)}


@dataclass(frozen=True)
class Trace:
    t: FloatArray
    channels: dict[str, FloatArray]


def trace(samples: int, late: float = 0.0, seed: int | None = None, span: float = 5.0) -> Trace:
    """x and a of a decay by a clock that is ``late`` (s), with noise unless there is no seed."""
    t = np.linspace(0.0, span, samples)
    motion, random = solve(DECAY, t), np.random.default_rng(seed)
    size = 0.0 if seed is None else 1.0
    channels = {"x": motion.x, "a": motion.a}
    return Trace(t + late, {c: y + size * NOISE[c].drawn(samples, random) for c, y in channels.items()})


@pytest.mark.parametrize(
    "samples", [900, pytest.param(2000, marks=pytest.mark.full), pytest.param(5000, marks=pytest.mark.full)]
)
def test_a_shift_is_found_with_an_honest_error(samples: int) -> None:
    apart = []
    for seed in range(12):
        found = align(trace(samples, 0.0371), trace(2000, seed=seed), NOISE, PERIOD)
        assert found.shift.value is not None
        assert found.shift.stderr is not None
        assert found.used == found.shift.value
        apart.append((found.shift.value + 0.0371) / found.shift.stderr)
    # of twelve draws of unit scatter: mean within three of its errors, rms below the 99.9 % point
    assert abs(np.mean(apart)) < 3.0 / np.sqrt(12.0)
    assert np.sqrt(np.mean(np.square(apart))) < 1.66


def test_a_shift_that_is_none_is_not_used() -> None:
    found = align(trace(2000), trace(2000, seed=3), NOISE, PERIOD)
    assert found.shift.value != 0.0
    assert found.used == 0.0
    assert found.covered.all()


def test_what_is_covered_is_where_the_first_shows_something() -> None:
    found = align(trace(2000, -40.0, span=4.0), trace(2000, seed=4), NOISE, PERIOD)
    assert found.shift.value == pytest.approx(40.0, abs=1e-4)
    assert np.mean(found.covered) == pytest.approx(0.8, abs=0.01)


def test_neighbours_a_period_away_are_told_with_their_ratio() -> None:
    found = align(trace(2000, PERIOD), trace(2000, seed=5), NOISE, PERIOD)
    assert found.shift.value == pytest.approx(-PERIOD, abs=1e-4)
    near = sorted(abs(other.shift + PERIOD) / PERIOD for other in found.alternatives)[:2]
    assert near == pytest.approx([1.0, 1.0], abs=0.1)
    assert min(other.worse_by for other in found.alternatives) > 10.0


def test_an_error_knows_of_cycles_that_cannot_be_told_apart() -> None:
    """A steady swing is the same a period later: the error is of the order of a period, and each cycle is named."""
    t = np.linspace(0.0, 20.0 * PERIOD, 4000)
    steady = [
        Trace(t, {"x": np.sin(10.0 * t) + Noise(1e-2, True).drawn(t.size, np.random.default_rng(seed))})
        for seed in (1, 2)
    ]
    found = align(steady[0], steady[1], {"x": Noise(0.0142, True)}, PERIOD)
    assert found.shift.stderr is not None
    assert found.shift.stderr > 0.5 * PERIOD
    assert min(other.worse_by for other in found.alternatives) < 1.1


def test_traces_of_one_driving_force_meet_by_it() -> None:
    """Their motions differ (another mass), the force is the same."""
    t, random = np.linspace(0.0, 20.0, 4000), np.random.default_rng(3)
    u = np.convolve(random.normal(size=t.size), np.hanning(80), "same")
    x = np.cumsum(u) * 1e-3
    noise = {"x": Noise(1e-4, True), "u": Noise(1e-2, True)}
    first = Trace(t - 7.0, {"x": np.roll(x, 90) * 0.6, "u": u})
    second = Trace(t, {"x": x, "u": u + noise["u"].drawn(t.size, random)})
    found = align(first, second, noise, 1.0)
    assert found.shift.value == pytest.approx(7.0, abs=3.0 * (found.shift.stderr or 0.0))
    assert (found.shift.stderr or 0.0) < 1e-2


def test_traces_too_long_for_their_period_are_refused() -> None:
    with pytest.raises(InputError, match="periods that the shift may be anywhere in"):
        align(trace(2000), trace(2000, span=1e5), NOISE, PERIOD / 100.0)


T = np.linspace(0.0, 4.0, 800)
X = 0.1 * np.exp(-0.2 * T) * np.cos(9.0 * T)


def recorded(name: str, angular: bool, *units: str) -> Recording:
    return Recording(
        T, {"x": X, "v": np.gradient(X, T)}, name, units=dict(zip("xv", units, strict=False)), angular=angular
    )


LENGTH, ANGLE = recorded("stage.csv", False, "mm"), recorded("joint.csv", True, "deg", "rpm")
BARE, TURNED = recorded("bare.csv", False), recorded("turned.csv", True)


def test_what_names_no_unit_is_of_the_others_kind_and_says_so() -> None:
    for one, other, units in ((BARE, ANGLE, "rad and rad/s"), (TURNED, LENGTH, "m and m/s")):
        found = as_kind_of(one, other)
        assert found.angular == other.angular
        assert np.array_equal(found["x"], X)
        assert found.notes == (f"Its columns name no unit: read in {units}, as {other.file}.",)
        for pair in (of_one_kind(one, other), of_one_kind(other, one)):
            assert {trace.angular for trace in pair} == {other.angular}
    assert as_kind_of(BARE, LENGTH) is BARE
    assert of_one_kind(BARE, TURNED)[0].angular
    with pytest.raises(InputError):
        of_one_kind(ANGLE, LENGTH)


def test_compare_refuses_them_too() -> None:
    with pytest.raises(InputError, match=re.escape("stage.csv: a length (x in mm), where joint.csv is an angle")):
        compare(LENGTH, ANGLE)
    assert compare(BARE, ANGLE).largest.unit == "rad"
