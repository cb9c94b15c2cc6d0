"""A log as it was read, before anybody has looked at what is in it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from harness.core.apart import Found
from harness.core.arrays import FloatArray
from harness.core.errors import InputError, did_you_mean
from harness.io.logs.rules import CHANNEL, Field

Fields = dict[Field, dict[str, FloatArray]]


@dataclass(frozen=True, slots=True)
class LogOptions:
    """How to read a log.

    columns : the text of --columns. joints : names in the model's order. topic : of a bag, or the episode of a data
    set. angle_unit : of positions that say none. skip_rows, rate (Hz), start, stop (s), drop_nan : as of a recording.
    names : of the log's joints the model's, "joint" or "joint.field" by either. flip : joints that turn the other way.
    offset : what is added to a position, rad or m, by joint.
    """

    columns: str | None = None
    joints: tuple[str, ...] | None = None
    topic: str | None = None
    angle_unit: str | None = None
    skip_rows: int = 0
    rate: float | None = None
    start: float | None = None
    stop: float | None = None
    drop_nan: bool = False
    names: Mapping[str, str] = field(default_factory=dict)
    flip: tuple[str, ...] = ()
    offset: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Raw:
    """Times and fields of joints as a file has them.

    t : (n,), s. fields : field, joint, values (n,) in SI; nan where nothing was logged. told : the unit a field came
    in, where the file or somebody says it. rows : what a row is called. numbered : joints have no names of their own.
    notes : what the reader did.
    """

    t: FloatArray
    fields: Fields
    told: Mapping[str, str] = field(default_factory=dict)
    rows: str = "row"
    numbered: bool = False
    notes: tuple[str, ...] = ()

    def found(self) -> Found:
        """As a process of its own hands it on."""
        columns = {f"{kind} {joint}": values for kind, of in self.fields.items() for joint, values in of.items()}
        about = {"told": dict(self.told), "rows": self.rows, "numbered": self.numbered, "notes": list(self.notes)}
        return {"t": self.t, **columns}, about


def from_found(columns: Mapping[str, FloatArray], about: Mapping[str, Any]) -> Raw:
    """What ``Raw.found`` gave."""
    fields: Fields = {}
    for key, values in columns.items():
        kind, _, joint = key.partition(" ")
        if kind in CHANNEL:
            fields.setdefault(kind, {})[joint] = values
    told, notes = dict(about["told"]), tuple(about["notes"])
    return Raw(columns["t"], fields, told, about["rows"], about["numbered"], notes)


def one_of(where: str, asked: str, known: list[str], what: str) -> InputError:
    """The error for a name that is not among those there are."""
    listed = ", ".join(known[:12]) + (", ..." if len(known) > 12 else "")
    listed = f"one of {listed}" if len(known) > 1 else listed or "none"
    return InputError(where, f"no {what} '{asked}'", f"{listed} is accepted{did_you_mean(asked, known)}")
