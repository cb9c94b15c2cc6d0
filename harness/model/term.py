"""What a catalogue entry says of itself: all there is to know of a term stands in its file.

Units SI, forces on the left-hand side of m x'' + c x' + k x + f = u.
"""

import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cache
from typing import Any, Final, Literal, TypeAlias

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.events import Regime


@dataclass(frozen=True, slots=True)
class Evidence:
    """The fitted motion and where the residual stands out, from which terms choose their starting values.

    x_scale (m), v_scale (m/s), peak_a (m/s^2): largest values. low, high : smallest and largest position, m.
    f_k, k, omega : of the fitted model (per unit mass where the mass is unknown), omega in rad/s. duration : s.
    frequencies : angular frequencies (rad/s) at which the residual stands out; of_friction : at which it does where it
    turns round with the motion. knock_times : times (s) worth a look.
    periods : of travel (m) at which the force left over stands out, empty where no force is looked at.
    driven : whether a force is recorded. angular : whether the unit of a channel was an angle.
    """

    x_scale: float
    v_scale: float
    peak_a: float
    low: float
    high: float
    f_k: float
    k: float
    omega: float
    duration: float
    frequencies: FloatArray
    knock_times: FloatArray
    driven: bool = False
    angular: bool = False
    periods: tuple[float, ...] = ()
    of_friction: FloatArray = field(default_factory=lambda: np.empty(0))


Spans: TypeAlias = tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class Seen:
    """A fitted motion at the times of a recording.

    t (n,), s. x (n,), m. channels : what the sensors show of it, each (n,). omega : its angular frequency, rad/s.
    """

    t: FloatArray
    x: FloatArray
    channels: Mapping[str, FloatArray]
    omega: float

    def where(self, inside: BoolArray) -> Spans:
        """Time spans (s) in which ``inside`` (n,) holds: each ends midway to the sample that is outside."""
        t = self.t
        edges = np.flatnonzero(np.diff(np.concatenate(([False], inside, [False])).astype(np.int8)))
        between = np.concatenate((t[:1], 0.5 * (t[1:] + t[:-1]), t[-1:]))
        return tuple((float(between[a]), float(between[b])) for a, b in zip(edges[::2], edges[1::2], strict=True))

    @property
    def whole(self) -> Spans:
        """The whole recording, s."""
        return ((float(self.t[0]), float(self.t[-1])),)


@dataclass(frozen=True, slots=True)
class Place:
    """Where an effect acts: times (s), regime, and the condition in words."""

    regime: Regime
    condition: str
    spans: Spans


Placed: TypeAlias = Callable[[tuple[float, ...], Seen], Place]
"""From the values of a term's parameters and the motion to the place."""


def always(regime: Regime = "throughout", condition: str = "always") -> Placed:
    """An effect that is bound to no part of the recording; regime and condition say where it shows most."""
    return lambda values, seen: Place(regime, condition, seen.whole)


@dataclass(frozen=True, slots=True)
class History:
    """The recorded motion up to the times asked for.

    t (n,), s, v (n,), m/s : recorded speed. at (m,), s : times asked for. v_at (m,) : speed there, 0 at rest. f_k : N.
    """

    t: FloatArray
    v: FloatArray
    at: FloatArray
    v_at: FloatArray
    f_k: float


@dataclass(frozen=True, slots=True)
class States:
    """Internal states (m, internal) at the times asked for, speeds relative to the slider's, and their partials.

    by : partials (m, internal) by the index of a parameter of the term or the name of a base parameter.
    """

    values: FloatArray
    by: Mapping[int | str, FloatArray] = field(default_factory=dict)


Implied: TypeAlias = Callable[[tuple[float, ...], History], States]
"""From the values of a term's parameters and the motion to its internal states."""


@dataclass(frozen=True, slots=True)
class Shown:
    """A channel behind a sensor, y (n,); by_y (n,) : its partial by what came in. by : partials (n,) by parameters.

    by_place (n,) : of an acceleration, its partial by the place.
    """

    y: FloatArray
    by_y: FloatArray
    by: tuple[FloatArray, ...]
    by_place: FloatArray | float = 0.0


Read: TypeAlias = Callable[[tuple[float, ...], FloatArray, FloatArray, FloatArray], Shown]
"""From the values of a term's parameters, times t (n,), the channel (n,) and what goes with it (n,): with x its rate,
with a the place, m; places from where the restoring force is nil.
"""


@dataclass(frozen=True, slots=True)
class Sensor:
    """The law of a term in slot O. channel : which one it changes. Those of a channel act in catalogue order.

    delays : the term's first parameter is by how much x is late, s; ``read`` is then given the channel of that moment.
    """

    channel: Literal["x", "a"]
    read: Read
    delays: bool = False


@dataclass(frozen=True, slots=True)
class Polynomial:
    """A restoring force a x + b x^2 + c x^3 and a damping force a v + b v|v| + c v^3."""

    stiffness: tuple[float, float, float] = (0.0, 0.0, 0.0)
    damping: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Zone:
    """A spring of this stiffness (N/m) that acts below ``low`` and above ``high`` (m)."""

    stiffness: float
    low: float = -math.inf
    high: float = math.inf


@dataclass(frozen=True, slots=True)
class Push:
    """A constant force (N) in the direction of x."""

    force: float


Element: TypeAlias = Polynomial | Zone | Push
MadeOf: TypeAlias = Callable[[tuple[float, ...], float], tuple[Element, ...]]
"""From the values of a term's parameters and the spring's stiffness k (N/m) to elements that say the whole term."""


LARGER: Final = "a release from a larger displacement"
REST: Final = "a recording that starts before the release and goes on well after rest"
SLOW: Final = "a slow to-and-fro drive with the force recorded, so that it breaks away several times"
AGAIN: Final = "the same release repeated after a pause"
DRIVEN: Final = {
    LARGER: "a drive over a longer way",
    REST: "a drive that pauses, long enough to see where it stays",
    SLOW: SLOW,
    AGAIN: "the same drive repeated after a pause",
}
"""What stands for each of them where nothing is let go but a force drives."""


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
FAMILIES = ("friction", "damping", "stiffness", "environment", "sensor")
_LAST = 1000


@dataclass(frozen=True, slots=True)
class Parameter:
    """One parameter of a term.

    unit : SI symbol with the force per unit mass where the mass is unknown; "1" for a pure number.
    lower, upper : bounds of what makes sense physically. none : the value at which the term has no effect, or None.
    positive : fitted through its logarithm. springs : upper bound in units of the spring's stiffness, None for none:
    what is stiffer gives way by less than a recording of the spring's motion can show.
    repeats : "time" for the angular frequency (rad/s) of a law that repeats in time, "travel" for the period (m) of one
    that repeats along the way. moment : whether it is a time (s) on the recording's clock. relaxes : whether it is the
    time (s) within which a law forgets. bends : whether it is the stiffness (N/m) of what bends until friction slides.
    """

    name: str
    unit: str
    lower: float = -float("inf")
    upper: float = float("inf")
    none: float | None = None
    positive: bool = False
    springs: float | None = None
    repeats: Literal["", "time", "travel"] = ""
    moment: bool = False
    relaxes: bool = False
    bends: bool = False


Probe = tuple[float, ...]
FreedFrom = Callable[[Probe, float, float], Sequence[Probe]]
"""From the values of a law whose form is freed, how long it was recorded (s), and the fastest speed (m/s)."""


@dataclass(frozen=True, slots=True)
class Known:
    """Where a law is known, and not only continued.

    of : "x", "|v|", "v", "-v", or "x, v". low, high : parameters that hold the ends, None for 0.
    fast, reach : of a law of both, parameters that hold the fastest speed, and how far out of the middle it is known,
    in shares of half the way and of the fastest speed, squares added.
    """

    of: Literal["x", "|v|", "v", "-v", "x, v"]
    low: int | None
    high: int
    fast: int | None = None
    reach: int | None = None

    @property
    def places(self) -> tuple[int, ...]:
        """Of the parameters that hold the ends."""
        return tuple(j for j in (self.low, self.high, self.fast, self.reach) if j is not None)

    def ends(self, values: Probe) -> tuple[float, float]:
        """Both ends, m or m/s."""
        return 0.0 if self.low is None else values[self.low], values[self.high]

    def out(self, values: Probe, x: FloatArray, v: FloatArray) -> FloatArray:
        """How far out of the middle places x, v (n,) of a law of both lie; see reach."""
        assert self.fast is not None
        low, high = self.ends(values)
        return np.asarray(np.hypot((2.0 * x - low - high) / (high - low), v / values[self.fast]), dtype=np.float64)


@cache
def _takes_time(law: Callable[..., None]) -> bool:
    """Whether t is among the arguments of a law."""
    code = law.__code__
    return "t" in code.co_varnames[: code.co_argcount]


def _nothing(values: tuple[float, ...], k: float) -> Mapping[str, str]:
    return {}


@dataclass(frozen=True, slots=True)
class Extent:
    """What a law's numbers are measured against: f_k (N), how far (m) and how fast (m/s) the slider moves at most.

    A reach of 0 and a speed of infinity, of a driven path, measure nothing. explains : whether a model with the law
    leaves noise alone, so that a corner of it is seen.
    """

    f_k: float
    reach: float
    speed: float
    explains: bool = False


def _no_look(evidence: Evidence) -> Sequence[Probe]:
    return ()


def _always(values: Probe, extent: Extent) -> bool:
    return True


@dataclass(frozen=True, slots=True, eq=False)
class Term:
    """A catalogue entry: a law in a slot, with what is needed to find, say, fit and simulate it.

    family : one of FAMILIES. parameters : of an event (time in s, impulse in N s), of a break-away force (f_s).
    sentence : format string over the parameters by name (dots of names kept), one plain sentence.
    example : values at which it matters to a slider of 1 kg, 100 N/m, 2 N that is let go at 1 m; tests use them.
    law : writes value and partials, see harness.model.law; None for events, break-away and sensors. A law that takes t
    is one that changes in time. corner : whether its value or its slope jumps somewhere.
    formula : the law as the catalogue page shows it, the docstring of ``law`` when empty.
    probes : full parameter tuples at which the response to ``amplitude`` is worth a look, from the evidence at hand;
    none given, where it has no effect.
    amplitude : index of the parameter in which the law is linear with none = no effect, or None.
    phase : index of the phase of a harmonic, so that a cosine and a sine probe make amplitude and phase.
    push : index of the size of a force that acts on a slider at rest at x = 0, or None.
    internal : number of internal states. speeds : those of them that are speeds, and start relative to the slider's.
    implied : internal states as a recorded motion leaves them, None where they are zero (speeds the slider's).
    channels : channels an observation needs. sensor : what it does to one of them.
    needs : "driven" (a recorded force), "angle", "spring", "zero" (a sensor of x whose zero is the spring's),
    "one-clock" (a phase or a moment in time of its own, which several recordings do not share), "returns" (a motion
    that comes back to the same places and speeds), "both-ways" (both directions).
    several : whether a model may have more than one. place : where it acts. only_there : whether nothing outside of
    those times shows it. words : more words of the sentence, from values and k. elements : see harness.model.term.
    in_python : the law as an expression of f_k, x, v, t and the parameters, for files that stand alone.
    as_named : whether values are what the name says; a law bent beyond it is not named.
    searched : whether it is looked for as a name; a table is none, and neither is a law whose form is freed.
    taken : share of the simulated machines without it of whose misfit it takes most all the same; 0 where that is no
    more than an ordinary law's. ``python -m benchmarks.calibrate taken`` counts it.
    frees : key of the law whose form it frees, by one number more; freed : from where it is fitted then.
    known : where a table is known, None for a law that
    holds everywhere. told_from : what recording would tell it from another name. steps_alike : whether the steps of an
    integrator show like it. variant : distinguishes laws that share a catalogue name. order : place in the catalogue.
    There is one object of each term. Raises TypeError for an entry that contradicts itself.
    """

    name: str
    family: str
    slot: Slot
    parameters: tuple[Parameter, ...]
    sentence: str
    law: Callable[..., None] | None = None
    probes: Callable[[Evidence], Sequence[Probe]] = _no_look
    amplitude: int | None = None
    phase: int | None = None
    internal: int = 0
    speeds: tuple[int, ...] = ()
    channels: tuple[str, ...] = ()
    needs: tuple[str, ...] = ()
    variant: str = ""
    example: Probe = ()
    formula: str = ""
    corner: bool = False
    push: int | None = None
    implied: Implied | None = None
    sensor: Sensor | None = None
    several: bool = False
    place: Placed = field(default=always())
    only_there: bool = False
    words: Callable[[tuple[float, ...], float], Mapping[str, str]] = _nothing
    as_named: Callable[[Probe, Extent], bool] = _always
    elements: MadeOf | None = None
    in_python: str = ""
    told_from: Mapping[str, str] = field(default_factory=dict)
    steps_alike: bool = False
    searched: bool = True
    taken: float = 0.0
    frees: str = ""
    freed: FreedFrom | None = None
    known: Known | None = None
    order: int = _LAST

    def __post_init__(self) -> None:
        lawless = self.slot in (Slot.EVENT, Slot.BREAK_AWAY, Slot.OBSERVATION)
        for wrong, why in (
            (self.family not in FAMILIES, f"family {self.family!r}: one of {', '.join(FAMILIES)}"),
            (len(self.example) != len(self.parameters), "example: a value for every parameter is needed"),
            ((self.law is None) != lawless, f"slot {self.slot} takes {'no law' if lawless else 'a law'}"),
            ((self.sensor is None) != (self.slot is not Slot.OBSERVATION), "a sensor belongs in slot O"),
            (not self.formula and self.law is None and self.sensor is None, "a formula is needed without a law"),
            (
                self.changes_in_time and any(p.unit == "rad/s" and p.repeats != "time" for p in self.parameters),
                'an angular frequency of a law that takes t is Parameter(..., repeats="time")',
            ),
        ):
            if wrong:
                raise TypeError(f"term {self.key}: {why}")
        if self.probes is _no_look and self.amplitude is not None:
            # the response to an amplitude is linear: one look, where the law has no effect, says all
            once = (tuple(float(p.none or 0.0) for p in self.parameters),)
            object.__setattr__(self, "probes", lambda evidence: once)

    @property
    def key(self) -> str:
        """Unique name: the catalogue's, with the variant where one name has several laws."""
        return f"{self.name}:{self.variant}" if self.variant else self.name

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters in their order."""
        return tuple(p.name for p in self.parameters)

    @property
    def changes_in_time(self) -> bool:
        """Whether its law takes t; one that does not cannot know the time."""
        return self.law is not None and _takes_time(self.law)

    @property
    def said(self) -> str:
        """The law in words and signs."""
        function = self.law if self.sensor is None else self.sensor.read
        return self.formula or inspect.getdoc(function) or ""

    def repeating(self, over: Literal["time", "travel"]) -> int | None:
        """Index of the parameter by which the law repeats in time or along the travel, or None."""
        return next((i for i, p in enumerate(self.parameters) if p.repeats == over), None)

    def say(self, values: dict[str, Any]) -> str:
        """The sentence with numbers."""
        return self.sentence.format(**values)
