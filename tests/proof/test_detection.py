"""The same case under growing noise, and the loss at which naming stops."""

import math
from typing import Any

import numpy as np
import pytest

from harness.core.errors import InputError
from harness.proof.detection import LOSSES, clean_loss, curve, draw_series


def test_only_the_noise_grows_and_the_loss_falls_with_its_square() -> None:
    steps = draw_series("quadratic-drag", 4, losses=(1000.0, 10.0))
    first, second = (step.case for step in steps)
    assert first.base == second.base
    assert first.effects == second.effects
    for channel in first.channels:
        assert second.noise.sigma[channel] == pytest.approx(10.0 * first.noise.sigma[channel])
        unit = [(c.recorded[channel] - c.clean[channel]) / c.noise.sigma[channel] for c in (first, second)]
        assert unit[0] == pytest.approx(unit[1], abs=1e-6)
        assert np.array_equal(first.clean[channel], second.clean[channel])
    for step in steps:
        assert clean_loss(step.case) == pytest.approx(step.loss, rel=0.05)
        # one chance draw of the loss: its deviation is twice its root, and five numbers of the base are fitted to noise
        assert abs(step.case.base_chi2_excess - step.loss) < 8.0 * math.sqrt(step.loss) + 15.0
        assert step.price == pytest.approx(math.log(step.case.base.samples * len(step.case.channels)))


def test_a_series_is_repeatable_and_says_what_it_is() -> None:
    first, second = (draw_series("sensor-lag", 1, 3, losses=(100.0,))[0] for _ in range(2))
    answer = first.answer()
    assert answer == second.answer()
    assert (answer["series"], answer["loss"], answer["mechanisms"]) == (3, 100.0, ["sensor-lag"])


@pytest.mark.parametrize("kind", ["static-friction", "nonsense", "alien-rattle"])
def test_what_does_not_show_in_a_decay_has_no_curve(kind: str) -> None:
    with pytest.raises(InputError, match=f"kind: {kind}"):
        draw_series(kind, 0)


def _answers(limit: float, cases: int = 12) -> tuple[dict[str, Any], dict[str, Any]]:
    """Verdicts that name everything above a loss and nothing below."""
    answers, results = {}, {}
    for series in range(cases):
        for loss in LOSSES:
            file = f"{series}-{loss:g}"
            answers[file] = {"mechanisms": ["stribeck"], "series": series, "loss": loss, "price": 15.0}
            named = loss > limit
            results[file] = {"verdict": "missing_physics", "mechanisms": [{"name": "stribeck"}]} if named else {
                "verdict": "adequate"
            }  # fmt: skip
    return answers, results


def test_the_curve_crosses_a_half_between_the_losses_named_and_not_named() -> None:
    found = curve(*_answers(30.0))
    assert [level.named.value for level in found.levels] == [1.0, 1.0, 1.0, 1.0, 0.0, 0.0]
    assert [level.payable for level in found.levels] == [12, 12, 12, 12, 12, 0]
    assert found.half == pytest.approx(math.sqrt(80.0 * 16.0))
    assert found.low == found.high == pytest.approx(found.half)
    assert found.limit == 15.0


def test_chance_widens_the_interval_and_keeps_the_crossing_inside() -> None:
    answers, results = _answers(30.0)
    for series in range(4):
        results[f"{series}-80"] = {"verdict": "adequate"}
        results[f"{series + 6}-16"] = {"verdict": "missing_physics", "mechanisms": [{"name": "stribeck"}]}
    found = curve(answers, results)
    assert found.half is not None
    assert found.low is not None
    assert found.high is not None
    assert found.low < found.half < found.high
    assert found.low > 3.0
    assert found.high < 400.0


@pytest.mark.parametrize(("limit", "what"), [(1e9, "nothing"), (0.0, "everything")])
def test_without_a_crossing_there_is_no_half(limit: float, what: str) -> None:
    assert curve(*_answers(limit)).half is None, what
