"""A hypothesis on what is missing, and how likely it is."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """names : what is missing; none where it is nothing, or no name by itself. probability : that it is so."""

    names: tuple[str, ...]
    probability: float
