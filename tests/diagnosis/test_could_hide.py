"""What an adequate driven recording could hide is said: how large a law, and what that shifts the numbers by."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.diagnosis.pipeline import diagnose, prepare
from harness.diagnosis.request import Asked
from harness.kernels.solve import Drive, solve
from harness.model.model import Model, ModelTerm, Restoring
from harness.results.common import P


def test_a_drag_too_small_to_be_seen_is_within_what_is_said_of_the_damping() -> None:
    t: FloatArray = np.arange(1000.0) / 70.0
    u = 6.0 * np.sin(3.1 * t) + 4.0 * np.sin(7.3 * t + 1.1)
    drag = ModelTerm.named("quadratic-drag", c2=0.08)
    x = solve(Model(2.0, 3.0, 80.0, 1.5, terms=(drag,)), t, drive=Drive(t, u)).x
    x = x + 1e-3 * np.random.default_rng(3).standard_normal(t.size)
    outcome = diagnose(prepare(Recording(t, {"x": x, "u": u}), Asked(Restoring.SPRING, zero_free=False))[0])
    assert outcome.verdict == "adequate"
    assert any("could hide" in warning for warning in outcome.warnings)
    for name, true in (("omega_n", 40.0**0.5), ("zeta", 3.0 / 2.0 / (2.0 * 40.0**0.5)), ("x_k", 1.5 / 80.0)):
        number = outcome.base_parameters[name]
        assert number.value is not None
        assert number.stderr is not None
        assert number.systematic is not None
        assert 0.0 < number.systematic < 30.0 * number.stderr
        assert abs(number.value - true) <= 2.0 * number.stderr + number.systematic
        assert P.of(number).model_dump()["systematic"] == number.systematic
