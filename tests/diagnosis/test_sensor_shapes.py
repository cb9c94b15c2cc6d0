"""What the shape of a sensor does to a channel: a curved scale of x, gravity in a; named, and told from other names."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

import harness
from harness.core.arrays import FloatArray
from harness.diagnosis.parameters import free_of, with_values
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.problems.simulated import observe
from harness.estimate.noise import Noise
from harness.kernels.solve import By
from harness.model.model import Model, ModelTerm
from harness.results.diagnosis import DiagnosisResult

BASE = Model(1.0, 0.1, 40.0, 0.04, x0=0.1, mass_known=False)
T = np.arange(0.0, 9.0, 0.03)
SIGMA = {"x": 1e-4, "a": 2e-2}


def diagnosed(channels: Mapping[str, FloatArray]) -> DiagnosisResult:
    """A decay as its sensors show it, with their noise."""
    random = np.random.default_rng(7)
    noisy = {c: y + SIGMA[c] * random.standard_normal(T.size) for c, y in channels.items()}
    return harness.diagnose(harness.Recording(T, noisy, "made"), zero="spring", engines=())


def named(found: DiagnosisResult, name: str, value: float) -> list[str]:
    """The names said, where this one is the first and its one number is within four standard errors."""
    first = found.mechanisms[0]
    assert first.name == name
    (number,) = first.parameters.values()
    assert number.value is not None
    assert number.stderr is not None
    assert abs(number.value - value) < 4.0 * number.stderr
    return [m.name for m in found.mechanisms]


def test_a_camera_in_perspective_is_no_spring_of_two_sides() -> None:
    """x + q x^2 moves the middle by q A^2/2 and adds as much of the second harmonic; a spring k2 x^2 has -3 to 1."""
    motion = harness.simulate(BASE, T)
    found = diagnosed({"x": motion.x + 0.3 * motion.x**2})
    assert named(found, "sensor-curvature", 0.3) == ["sensor-curvature"]


def test_gravity_in_an_accelerometer_leaves_the_jumps_of_friction_as_they_are() -> None:
    """A gain scales them too."""
    motion = harness.simulate(replace(BASE, f_k=0.1), T)
    found = diagnosed({"x": motion.x, "a": motion.a + 9.81 * motion.x})
    assert named(found, "sensor-gravity", 9.81) == ["sensor-gravity"]


def test_sensors_that_are_straight_and_upright_are_quiet() -> None:
    motion = harness.simulate(BASE, T)
    assert diagnosed({"x": motion.x, "a": motion.a}).verdict == "adequate"


def test_partials_through_shapes_are_those_of_differences() -> None:
    terms = (
        ModelTerm.named("sensor-gravity", per_place=7.0),
        ModelTerm.named("sensor-gain", gain=0.9),
        ModelTerm.named("sensor-drift", rate=0.01),
        ModelTerm.named("sensor-curvature", q=0.3),
    )
    model = replace(BASE.with_terms(*terms), offset=0.02)
    problem = FreeDecay(T, dict.fromkeys(SIGMA, T), {c: Noise(s, True) for c, s in SIGMA.items()})
    places: dict[By, float] = {"k": 40.0, "x0": 0.1, "offset": 0.02, (0, 0): 7.0, (3, 0): 0.3}
    partials = observe(model, problem, tuple(places)).dy

    free = free_of(model, tuple(b for b in places if isinstance(b, str)))

    def shown(by: By, value: float) -> Mapping[str, FloatArray]:
        return observe(with_values(model, tuple(f for f in free if f.by == by), np.array([value])), problem).y

    for column, (by, value) in enumerate(places.items()):
        step = 1e-4 * value
        up, down = shown(by, value + step), shown(by, value - step)
        for c in SIGMA:
            differences = (up[c] - down[c]) / (2.0 * step)
            wanted = 1e-3 * np.max(np.abs(differences)) + 1e-9
            # beside a reversal that moves an acceleration jumps
            off = np.abs(partials[c][:, column] - differences)
            assert np.quantile(off, 0.95) < wanted, (by, c)
