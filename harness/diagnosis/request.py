"""What was asked of a diagnosis, beside its recording."""

from dataclasses import dataclass

from harness.model.covariate import Acts
from harness.model.model import Restoring


@dataclass(frozen=True, slots=True)
class AskedCovariate:
    """A column that acts on the slider; acts : how, None: chosen at the base fit."""

    name: str
    acts: Acts | None = None


@dataclass(frozen=True, slots=True)
class Asked:
    """What was asked of a diagnosis: see the options of the same names, which are checked there; s, kg.

    restoring, zero_free : None where nobody said; they are then chosen at the base fit. guarded : a fitted
    force does not count beside reversals, where a servo lets the slider stick.
    """

    restoring: Restoring | None = None
    zero_free: bool | None = None
    mass: float | None = None
    horizon: float | None = None
    covariates: tuple[AskedCovariate, ...] = ()
    guarded: bool = False
