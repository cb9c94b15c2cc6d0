"""Where nothing is missing, one term too many does not spoil the prediction of what was held out, nor help it much."""

import numpy as np
import pytest

from harness.diagnosis.pipeline import diagnose
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.estimate.noise import channel_noise
from harness.proof.plant import draw


@pytest.mark.parametrize("seed", [3, 4])
def test_a_control_is_predicted_as_well_with_the_best_ranked_term_forced_in(seed: int) -> None:
    case = draw("control", np.random.default_rng(seed))
    t, channels = case.recorded["t"], {c: case.recorded[c] for c in case.channels}
    outcome = diagnose(FreeDecay(t, channels, {c: channel_noise(t, y) for c, y in channels.items()}))
    assert outcome.verdict == "adequate"
    forced = outcome.holdout.forced
    assert forced is not None
    assert forced.name
    assert set(forced.refined_rmse) == set(channels)
    for channel, after in forced.refined_rmse.items():
        assert 0.95 < after / forced.baseline_rmse[channel] <= 1.05
