"""What speaks against a model where the noise of a force moves reversals past samples."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.diagnosis.problems.force_noise import FAR
from harness.diagnosis.search.against import against, far_out, in_turn

NOISY: Any = SimpleNamespace(spare=12.0)
QUIET: Any = SimpleNamespace(spare=0.0)


def fit(residual: FloatArray, numbers: int = 3) -> Any:
    chi2 = float(residual @ residual)
    return SimpleNamespace(residual=residual, bic=chi2 + numbers * np.log(residual.size))


def test_a_sample_on_the_other_side_of_a_jump_says_no_more_than_that_it_is_far_out() -> None:
    """Of a slider that nothing is missing of, a knock of nought takes one sample off that is 18 deviations out."""
    noise = np.random.default_rng(2).standard_normal(900)
    apart = noise.copy()
    apart[400] = 18.0
    base, knock = fit(apart), fit(noise, 5)
    assert against(base, QUIET) - against(knock, QUIET) == pytest.approx(18.0**2 - noise[400] ** 2 - 2.0 * np.log(900))
    assert against(base, NOISY) - against(knock, NOISY) == pytest.approx(FAR**2 - noise[400] ** 2 - 2.0 * np.log(900))
    assert in_turn([base, knock], NOISY) == in_turn([knock, base], QUIET) == (knock, base)


def test_what_many_samples_say_is_said_as_well_with_the_bound() -> None:
    """An effect of three deviations in each sample counts as it did."""
    noise = np.random.default_rng(3).standard_normal(900)
    misfit, law = fit(noise + 3.0 * np.sin(np.arange(900.0))), fit(noise, 4)
    gain = misfit.bic - law.bic
    assert against(misfit, NOISY) - against(law, NOISY) == pytest.approx(gain, rel=0.02)
    assert against(misfit, QUIET) - against(law, QUIET) == pytest.approx(gain)


def test_far_out_is_what_is_beyond_the_bound() -> None:
    assert far_out(fit(np.array([FAR, -FAR, 0.0, 1.0]))) == 0.0
    assert far_out(fit(np.array([-6.0, 8.0, 2.0]))) == pytest.approx(36.0 + 64.0 - 2.0 * FAR**2)
