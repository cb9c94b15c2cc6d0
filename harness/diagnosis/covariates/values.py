"""The columns that were asked for as covariates, or why one says nothing."""

from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.request import AskedCovariate
from harness.diagnosis.rules import COVARIATE_VARIES
from harness.estimate.noise import channel_noise
from harness.model.covariate import Acts, Covariate


@dataclass(frozen=True, slots=True)
class Acting:
    """A covariate of a recording that is followed.

    acts : how it enters, None where that is to be found. about : its mean. unit : "" where the recording gives none.
    noise : of a sample, in its unit. asked : whether somebody said how it enters.
    """

    name: str
    acts: Acts | None
    about: float
    unit: str
    noise: float
    asked: bool = False

    def entering(self, acts: Acts, levelled: bool) -> Covariate:
        """In a model, with no effect yet; levelled : whether the level of a force can be told from the zero."""
        return Covariate(self.name, acts, 0.0, self.about, self.unit, levelled=levelled)


def values_in(recording: Recording, asked: tuple[AskedCovariate, ...]) -> dict[str, FloatArray]:
    """The columns (n,) that were asked for. Raises InputError for one that is not there or says nothing."""
    found = {}
    for one in asked:
        where = f"{recording.file}: covariate {one.name}"
        if one.name not in recording.covariates:
            there = ", ".join(recording.covariates) or "none"
            raise InputError(where, "no such column", f"a covariate of the recording is accepted ({there})")
        values = recording.covariates[one.name]
        spread, accepted = float(np.std(values)), f"a spread of {COVARIATE_VARIES.value:g} times its noise is accepted"
        if float(np.ptp(values)) == 0.0:
            raise InputError(where, f"the constant {values[0]:g}", accepted)
        noise = channel_noise(recording.t, values).sigma
        if spread < COVARIATE_VARIES.value * noise:
            found_too = f"hardly varies: {spread:.3g} about its mean, of which noise is {noise:.3g}"
            raise InputError(where, found_too, accepted)
        found[one.name] = values
    return found
