"""A driven recording whose force is fitted: no force that is known says its motion well enough to follow it."""

from dataclasses import dataclass, field

from harness.diagnosis.problems.driven import Driven, Forced
from harness.diagnosis.problems.starts import Windows


@dataclass(frozen=True, slots=True, kw_only=True)
class InverseDynamics(Forced):
    """The force is what is fitted; the motion over the windows is only shown.

    enters : how each covariate was found to enter, and that a mass was not seen, one sentence each.
    """

    starts: Windows = field()
    enters: tuple[str, ...] = ()

    @property
    def alone(self) -> tuple["InverseDynamics", ...]:
        """Each recording by itself, where there are several."""
        return ()

    @property
    def choices(self) -> tuple[str, ...]:
        """How covariates enter, and what mass was taken."""
        return self.enters

    @property
    def errors_allow_for_misfit(self) -> bool:
        """Always: they come from the residual's own covariance with the partials."""
        return True

    @classmethod
    def of(cls, driven: Driven, windows: Windows) -> "InverseDynamics":
        """The same recording, with its force fitted."""
        return cls(
            driven.t,
            driven.channels,
            driven.noise,
            weight=driven.weight,
            mass=driven.mass,
            restoring=driven.restoring,
            zero_free=driven.zero_free,
            angular=driven.angular,
            starts=windows,
            drive=driven.drive,
            first=driven.first,
            covariates=driven.covariates,
            guarded=driven.guarded,
        )
