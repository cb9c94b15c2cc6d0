"""The columns that were asked for as covariates, or why one says nothing.

Ways in which a covariate may enter, side by side: what was chosen, by how much, and what is not told apart.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.request import AskedCovariate
from harness.diagnosis.rules import COVARIATE_APART, COVARIATE_VARIES, DECISIVE
from harness.estimate.noise import Noise, channel_noise
from harness.fit.series import memory
from harness.model.covariate import Acts, Covariate


@dataclass(frozen=True, slots=True)
class Acting:
    """A covariate of a recording.

    acts : how it enters, None where that is to be found. about : its mean. unit : "" where the recording gives none.
    noise : of it, in its unit. file : of the recording. asked : whether somebody said how it enters.
    """

    name: str
    acts: Acts | None
    about: float
    unit: str
    noise: Noise
    file: str
    asked: bool = False

    @classmethod
    def of(cls, one: AskedCovariate, *recordings: Recording) -> "Acting":
        """As it was asked for, in all recordings of a machine together."""
        values, noise = _laid(one.name, recordings)
        unit, file = recordings[0].units.get(one.name, ""), ", ".join(recording.file for recording in recordings)
        return cls(one.name, one.acts, float(np.mean(values)), unit, noise, file, one.acts is not None)

    def entering(self, acts: Acts, levelled: bool) -> Covariate:
        """In a model, with no effect yet; levelled : whether the level of a force can be told from the zero."""
        return Covariate(self.name, acts, 0.0, self.about, self.unit, levelled=levelled)


def values_in(asked: tuple[AskedCovariate, ...], *recordings: Recording) -> dict[str, FloatArray]:
    """The columns (n,) that were asked for, of recordings of a machine one behind the other.

    Raises InputError for one that is not there, and for one of a recording by itself that says nothing: of several it
    may be what pushes all the time.
    """
    found = {}
    for one in asked:
        for recording in recordings:
            if one.name not in recording.covariates:
                there = ", ".join(recording.covariates) or "none"
                where = f"{recording.file}: covariate {one.name}"
                raise InputError(where, "no such column", f"a covariate of the recording ({there})")
        where = f"{recordings[0].file}: covariate {one.name}"
        values, noise = _laid(one.name, recordings)
        found[one.name] = values
        if len(recordings) > 1:
            continue
        spread, accepted = float(np.std(values)), f"a spread of {COVARIATE_VARIES.value:g} times its noise"
        if float(np.ptp(values)) == 0.0:
            raise InputError(where, f"the constant {values[0]:g}", accepted)
        if spread < COVARIATE_VARIES.value * noise.sigma:
            found_too = f"hardly varies: {spread:.3g} about its mean, of which noise is {noise.sigma:.3g}"
            raise InputError(where, found_too, accepted)
    return found


def _laid(name: str, recordings: Sequence[Recording]) -> tuple[FloatArray, Noise]:
    """A column (n,) of recordings one behind the other, and its noise where that is most.

    The rows of a table without time follow no course that would show any.
    """
    each = [(one, one.covariates[name]) for one in recordings]
    noise = [Noise(0.0, False) if one.steady else channel_noise(one.t, values) for one, values in each]
    return np.concatenate([values for _, values in each]), max(noise, key=lambda one: one.sigma)


NAMED = {Acts.FORCE: "a force", Acts.FRICTION: "friction", Acts.DAMPING: "damping"}


@dataclass(frozen=True, slots=True)
class Rival:
    """One way in, and what it leaves (m,)."""

    covariate: Covariate
    left: FloatArray


def said(found: Sequence[Rival], without: FloatArray, asked: bool, refused: tuple[Acts, ...]) -> str:
    """Which rival was chosen, the first, and by how much, in BIC; without (m,) : what is left where it does not act.

    refused : ways that follow from the base model and time.
    """
    best = found[0]
    name, independent = best.covariate.name, memory(best.left).independent

    def behind(left: FloatArray) -> float:
        return independent * math.log(float(left @ left) / max(float(best.left @ best.left), 1e-300))

    gained = behind(without) - math.log(independent)
    parts = [f"BIC {gained:.0f} better than without it"]
    parts += [f"{behind(r.left):.0f} better than as {NAMED[r.covariate.acts]}" for r in found[1:]]
    parts += [f"{NAMED[acts]} was not tried, as that follows from the base model and time" for acts in refused]
    text = f"{name} enters as {best.covariate.said}{', as asked' if asked else ''}: {', '.join(parts)}."
    near = [NAMED[r.covariate.acts] for r in found[1:] if behind(r.left) < DECISIVE.value]
    if near:
        text += f" Below {DECISIVE.value:g} it cannot be distinguished from {' or '.join(near)}."
    if gained < DECISIVE.value:
        text += f" Below {DECISIVE.value:g} nothing shows that {name} acts at all."
    return f"{text} Held-out figures are given {name}; it is not predicted."


def little(name: str, share: float) -> str:
    """A caution where little of a covariate decides its gain; share : of its squares that nothing else says."""
    if share * COVARIATE_APART.value >= 1.0:
        return ""
    found = f"The base model and time say {100.0 * (1.0 - share):.3g} % of what {name} does"
    return f" {found}: the rest decides the gain, and a missing law moves it easily."
