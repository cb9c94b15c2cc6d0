"""What a catalogue entry says of itself."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from harness.model.evidence import Evidence


class Slot(StrEnum):
    """The five slots of a model, the friction slot by its parts."""

    SMOOTH = "S"
    FRICTION_LAW = "F law"
    FRICTION_LEVEL = "F level"
    FRICTION_MODULATION = "F modulation"
    BREAK_AWAY = "F break-away"
    INTERNAL = "I"
    EVENT = "E"
    OBSERVATION = "O"


SINGLE = frozenset({Slot.FRICTION_LAW, Slot.FRICTION_LEVEL, Slot.BREAK_AWAY})
"""Slots that take one entry."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """One parameter of a term.

    unit : SI symbol with the force per unit mass where the mass is unknown; "1" for a pure number.
    lower, upper : bounds of what makes sense physically. none : the value at which the term has no effect, or None.
    positive : fitted through its logarithm. springs : upper bound in units of the spring's stiffness, None for none:
    what is stiffer gives way by less than a recording of the spring's motion can show.
    """

    name: str
    unit: str
    lower: float = -float("inf")
    upper: float = float("inf")
    none: float | None = None
    positive: bool = False
    springs: float | None = None


Probe = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Term:
    """A catalogue entry: a law in a slot, with what is needed to find, say, fit and simulate it.

    law : writes value and partials, see harness.model.law; None for slots that the kernel itself realises.
    probes : full parameter tuples at which the response to ``amplitude`` is worth a look, from the evidence at hand.
    amplitude : index of the parameter in which the law is linear with none = no effect, or None.
    phase : index of the phase of a harmonic, so that a cosine and a sine probe make amplitude and phase.
    sentence : format string over the parameters by name (dots of names kept), one plain sentence.
    internal : number of internal states. speeds : those of them that are speeds, and start relative to the slider's.
    channels : channels an observation needs. needs : "driven", "angle", "spring".
    variant : tells laws apart that share a catalogue name.
    """

    name: str
    family: str
    slot: Slot
    parameters: tuple[Parameter, ...]
    sentence: str
    law: Callable[..., None] | None = None
    probes: Callable[[Evidence], Sequence[Probe]] = field(default=lambda evidence: ())
    amplitude: int | None = None
    phase: int | None = None
    internal: int = 0
    speeds: tuple[int, ...] = ()
    channels: tuple[str, ...] = ()
    needs: tuple[str, ...] = ()
    variant: str = ""

    @property
    def key(self) -> str:
        """Unique name: the catalogue's, with the variant where one name has several laws."""
        return f"{self.name}:{self.variant}" if self.variant else self.name

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters in their order."""
        return tuple(p.name for p in self.parameters)

    def say(self, values: dict[str, Any]) -> str:
        """The sentence with numbers."""
        return self.sentence.format(**values)
