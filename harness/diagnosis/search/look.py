"""A first look at the catalogue on a model: what each law promises, and which of them are worth a fit."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from harness.core.errors import SimulationError
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import PAIR_PROMISE, SCREEN_GAIN, SCREEN_GAIN_OF_ONE, SCREEN_SHARE
from harness.diagnosis.search.screen import Candidate, direct, screen
from harness.diagnosis.search.start_evidence import evidence
from harness.kernels.solve import Scales
from harness.model.evidence import Evidence
from harness.model.term import Term

_BEYOND = 3.0
"""Standard deviations of chi-square from which a fit leaves something, so that knocks are looked for."""


@dataclass(frozen=True, slots=True)
class Look:
    """What laws promise on a model, most promising first.

    fitted : the model, in ``part`` of a recording. terms : those that were looked at. found : of those with a linear
    amplitude; None on a model too stiff for a first look, on which nothing is built.
    """

    fitted: Fit
    part: Problem
    seen: Evidence
    terms: Sequence[Term]
    found: tuple[Candidate, ...] | None

    @classmethod
    def at(cls, fitted: Fit, part: Problem, scales: Scales, terms: Sequence[Term]) -> "Look":
        """One simulation or a few."""
        seen = evidence(fitted, part, scales)
        try:
            found = tuple(screen(fitted, part, seen, scales, terms))
        except SimulationError:
            return cls(fitted, part, seen, terms, None)
        return cls(fitted, part, seen, terms, found)

    @property
    def most(self) -> float:
        """The best promise, chi-square."""
        return self.found[0].gain if self.found else 0.0

    def gain_of(self, name: str) -> float | None:
        """The best promise of a catalogue name, chi-square; None where it promises nothing."""
        return max((c.gain for c in self.found or () if c.term.name == name), default=None)

    def worthy(self) -> list[Candidate]:
        """What is worth a fit, and the laws that no first look can tell of where something is left for them."""
        if self.found is None:
            return []
        least = max(SCREEN_GAIN.value, SCREEN_SHARE.value * self.most)
        of_one = SCREEN_GAIN_OF_ONE.value
        worthy = [c for c in self.found if c.gain >= (least if len(c.term.parameters) > 1 else of_one)]
        excess = self.fitted.chi2 - self.fitted.points
        if excess > _BEYOND * math.sqrt(2.0 * self.fitted.points) or self.most > 2.0 * math.log(self.fitted.points):
            worthy += direct(self.fitted, self.part, self.seen, self.terms)
        return worthy

    @property
    def promises_an_end(self) -> bool:
        """Whether a law may bring the model near the noise: else no pair with it explains."""
        return bool(self.found) and self._left(self.most) <= PAIR_PROMISE.value

    def ending(self) -> list[Candidate]:
        """Of what is worth a fit, that which may bring the model near the noise, or of which no look can tell."""
        least = SCREEN_SHARE.value * self.most
        return [
            c
            for c in self.worthy()
            if c.term.amplitude is None or (c.gain >= least and self._left(c.gain) <= PAIR_PROMISE.value)
        ]

    def _left(self, gain: float) -> float:
        """Chi-square a point beyond a gain."""
        return (self.fitted.chi2 - gain) / self.fitted.points
