"""A log as it was read becomes one to work with: joints chosen, repeats dropped, what is odd said.

Positions in shares of a calibrated range, as LeRobot's motors write them, become angles by their calibration file:
-100 to 100 of the range that was passed at calibration, 0 to 100 for grippers, of a turn of 4096 steps
(lerobot/motors/motors_bus.py). Signs are the log's.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.core.bounded import MOST_DOCUMENT_BYTES, parse_json, read_bytes
from harness.core.errors import InputError
from harness.core.recording import LARGEST, LONGEST_TIME
from harness.core.robot import JointLog
from harness.io.encoders import unwrapped
from harness.io.logs.naming import no_such, renamed, same_joints
from harness.io.logs.raw import SI_UNITS, Field, Fields, LogOptions, Raw, one_of
from harness.io.logs.suspicions import called, coarse, degrees, odd_velocity, unsigned
from harness.io.times import evened, sampling_notes
from harness.io.units import parse_unit

Gain = float | Mapping[str, float]
_BESIDE: tuple[Literal["goal", "voltage", "driven", "temperature"], ...] = ("goal", "voltage", "driven", "temperature")
"""What a log has beside motion and effort."""

_COUNTS, _SMALLER = 4096, 1024
"""Of a turn, in the position registers of Dynamixel's X and Feetech's STS; of their older ones, over another range."""


@dataclass(frozen=True, slots=True)
class Finished:
    """What a ``JointLog`` is made of, of any length; arrays of shape (n,). beside : currents, and
    efforts without a sign. unit : of positions as they came, "" where none is said of all."""

    t: FloatArray
    position: Mapping[str, FloatArray]
    velocity: Mapping[str, FloatArray]
    effort: Mapping[str, FloatArray]
    beside: Fields
    notes: tuple[str, ...]
    unit: str

    def log(self, file: str, sha256: str) -> JointLog:
        """The log; InputError for one that holds too little."""
        more = {kind: self.beside.get(kind, {}) for kind in _BESIDE}
        return JointLog(
            self.t, self.position, self.velocity, self.effort, file, sha256, self.notes, unit=self.unit, **more
        )


def finished(raw: Raw, file: str, options: LogOptions, gain: Gain | None) -> Finished:
    """Choose, check and clean. Raises InputError naming the joint, row or option that is wrong."""
    # joints without names of their own have the model's, by which --names calls them
    raw = raw if raw.numbered else renamed(calibrated(raw, options.calibration), options.names, options.joints)
    numbered, raw = raw.numbered, _chosen(raw, file, options.joints)
    raw = renamed(calibrated(raw, options.calibration), options.names, None) if numbered else raw
    raw = _counted(raw) if options.calibration is None and options.angle_unit is None else raw
    raw = _turned(_multiplied(_logged(raw), file, gain), options)
    raw = _in_order(_rows(raw, file, options.drop_nan), file)
    raw = _cut(raw, file, options)
    fields, notes = {kind: dict(of) for kind, of in raw.fields.items()}, list(raw.notes)
    position, velocity, effort = (fields.get(kind, {}) for kind in ("position", "velocity", "effort"))
    if raw.t.size > 2:
        t, rounded = evened(raw.t, max(position.values(), key=np.ptp, default=raw.t))
        raw = replace(raw, t=t)
        notes += filter(None, [rounded, *_unwrapped(t, position, raw.told.get("position"))])
        notes += filter(None, [degrees(position, raw.told.get("position", ""))])
        notes += odd_velocity(raw.t, position, velocity)
        signless = unsigned(position, effort)
        if signless:
            notes.append(
                f"The effort of {called(signless, len(effort))} never is negative although the joints move both ways: "
                "it has no sign, says nothing of friction, and is not used."
            )
            fields["magnitude"] = {joint: effort[joint] for joint in signless}
            effort = {joint: u for joint, u in effort.items() if joint not in signless}
        notes += [*coarse("velocity", velocity), *coarse("effort", effort), *sampling_notes(raw.t)]
    kinds: tuple[Field, ...] = ("current", "magnitude", *_BESIDE)
    beside = {kind: fields[kind] for kind in kinds if fields.get(kind)}
    return Finished(raw.t, position, velocity, effort, beside, tuple(notes), raw.told.get("position", ""))


def _counted(raw: Raw) -> Raw:
    """Positions and goals of bus servos' registers, 4096 a turn from 2048, in rad: whole numbers that no unit is said
    of, beyond what a hinge or a sensor of 1024 steps can have."""
    those = [y for kind in ("position", "goal") for y in raw.fields.get(kind, {}).values()]
    largest = max((float(np.max(y, initial=0.0)) for y in those), default=0.0)
    whole = all(bool(np.all((y == np.round(y)) & (y >= 0.0))) for y in those)
    if "position" in raw.told or not (whole and _SMALLER <= largest < _COUNTS):
        return raw
    fields = dict(raw.fields)
    for kind in ("position", "goal"):
        of = fields.get(kind, {})
        fields[kind] = {joint: (y - 0.5 * _COUNTS) * (2.0 * np.pi / _COUNTS) for joint, y in of.items()}
    said = f"Positions are whole numbers up to {largest:.0f}: read as a servo's register, 4096 a turn from 2048."
    return replace(raw, fields=fields, notes=(*raw.notes, said))


def _unwrapped(t: FloatArray, position: dict[str, FloatArray], unit: str | None) -> list[str]:
    """What is said of positions that wrap by a turn or more; in ``position`` each is put together to one course."""
    said = []
    factor = 1.0 if unit is None else parse_unit("unit", "x", unit).factor
    for joint, x in position.items():
        position[joint], note = unwrapped(t, x, None, factor)
        said += [f"{joint}: {note[0].lower()}{note[1:]}"] if note else []
    return said


def _turned(raw: Raw, options: LogOptions) -> Raw:
    """Joints that turn the other way, and other zeros of their positions."""
    have, fields, notes = list(raw.fields.get("position", {})), dict(raw.fields), list(raw.notes)
    for option, joints in (("--flip", options.flip), ("--offset", tuple(options.offset))):
        for joint in joints:
            if joint not in have:
                raise one_of(option, joint, have, "joint")
    if options.flip:
        for kind, of in fields.items():
            if kind not in ("voltage", "driven"):
                fields[kind] = {joint: -values if joint in options.flip else values for joint, values in of.items()}
        notes.append(f"Position, velocity and effort of {', '.join(options.flip)} have the other sign (--flip).")
    if options.offset:
        for kind in ("position", "goal"):
            of = fields.get(kind, {})
            fields[kind] = {joint: values + options.offset.get(joint, 0.0) for joint, values in of.items()}
        said = ", ".join(f"{value:.4g} to {joint}" for joint, value in options.offset.items())
        notes.append(f"Added to positions: {said} (--offset).")
    return replace(raw, fields=fields, notes=tuple(notes))


def _chosen(raw: Raw, file: str, joints: tuple[str, ...] | None) -> Raw:
    """The joints of the model: by name, or in its order where the log's have none."""
    have = list(raw.fields.get("position", {}))
    if joints is None:
        return raw
    if raw.numbered:
        names = dict(zip(have, joints, strict=False))
        if len(joints) != len(have):
            few = min(len(joints), len(have))
            said = (
                f"The log has {len(have)} joints and the model {len(joints)}: the first {few} are taken, in its order."
            )
        else:
            said = f"Joints have no names in the log: {', '.join(joints)} are taken for them, in the model's order."
    else:
        names = same_joints(have, joints)
        if not names:
            raise no_such(file, have, joints)
        without = [joint for joint in joints if joint not in names.values()]
        taken = ", ".join(f"{joint} is {other}" for joint, other in names.items() if joint != other)
        said = f"Of the log's joints {taken}, by the last part of their names. " if taken else ""
        said = f"{said}The log has no {', '.join(without)}." if without else said.strip()
    fields: Fields = {
        kind: {names[joint]: values for joint, values in of.items() if joint in names}
        for kind, of in raw.fields.items()
    }
    return replace(raw, fields=fields, notes=(*raw.notes, *filter(None, [said])))


def _logged(raw: Raw) -> Raw:
    """Without what is nan or zero throughout, which is what drivers write for what they do not know."""
    fields: Fields = {}
    notes = list(raw.notes)
    for kind, of in raw.fields.items():
        kept = {joint: y for joint, y in of.items() if not np.all(np.isnan(y))}
        if kind == "temperature":  # read seldom, and slow
            kept = {joint: _between(raw.t, y) for joint, y in kept.items()}
        if kind not in ("position", *_BESIDE):
            still = [joint for joint, y in kept.items() if np.all(y == 0.0)]
            if still and len(still) == len(kept):
                notes.append(f"The {_SAID.get(kind, kind)} is 0 throughout: taken as not logged.")
                kept = {}
        if len(kept) < len(of) and kept:
            gone = [joint for joint in of if joint not in kept]
            notes.append(f"No {kind} is logged of {called(gone, len(of))}.")
        bare = [joint for joint in kept if joint not in raw.fields["position"]]
        if bare:
            notes.append(f"No position is logged of {called(bare, len(of) + 1)}: its {kind} is not used.")
        if len(bare) < len(kept):
            fields[kind] = {joint: y for joint, y in kept.items() if joint not in bare}
    if raw.fields.get("magnitude"):
        notes.append("An effort without its sign is logged: it says nothing of friction, and is not used.")
    return replace(raw, fields=fields, notes=tuple(notes))


def _between(t: FloatArray, y: FloatArray) -> FloatArray:
    """Values (n,) in place of those that are nan, from their neighbours."""
    known = np.isfinite(y) & np.isfinite(t)
    return y if known.all() or not known.any() else np.interp(t, t[known], y[known])


_SAID = {"magnitude": "effort without its sign"}


def _multiplied(raw: Raw, file: str, gain: Gain | None) -> Raw:
    """Efforts from currents, N m per A; where a gain is given and no current is named, the effort is one."""
    current = raw.fields.get("current", {})
    if gain is None:
        if current and not raw.fields.get("effort"):
            said = "Current is logged and no effort: --gain, in N m per A at the joint, makes one of it."
            return replace(raw, notes=(*raw.notes, said))
        return raw
    source = current or raw.fields.get("effort", {})
    if not source:
        raise InputError(f"{file}: --gain", "given for a log without current or effort", "a log with one")
    gains = dict(gain) if isinstance(gain, Mapping) else dict.fromkeys(source, gain)
    for joint in gains:
        if joint not in source:
            raise one_of("--gain", joint, list(source), "joint")
    fields = dict(raw.fields)
    kept = {} if current else source
    fields["effort"] = {**kept, **{joint: gains[joint] * y for joint, y in source.items() if joint in gains}}
    values = sorted({float(value) for value in gains.values()})
    shown = f"{values[0]:g}" if len(values) == 1 else f"{values[0]:g} to {values[-1]:g}"
    what = "Current" if current else "What is logged as effort is taken as current, in A, and"
    notes = [f"{what} times {shown} N m per A is the effort (--gain)."]
    if not isinstance(gain, Mapping) and len(source) > 1 and abs(gain) != 1.0:
        notes.append(f"One --gain for {len(source)} joints: where motors or gears differ, give one each, A,B,...")
    return replace(raw, fields=fields, notes=(*raw.notes, *notes))


def _rows(raw: Raw, file: str, drop_nan: bool) -> Raw:
    """Without rows that lack a value, where that was asked; InputError for the first value that is none, else."""
    kept = {kind: of for kind, of in raw.fields.items() if kind in ("position", "velocity", "effort", *_BESIDE)}
    channels = [("t", raw.t, LONGEST_TIME)]
    channels += [(f"{joint}.{kind}", y, LARGEST) for kind, of in kept.items() for joint, y in of.items()]
    notes = raw.notes
    others = np.all([np.isnan(y) for _, y, _ in channels[1:]], axis=0)
    if len(channels) > 2 and others.any() and not others.all():
        notes = (*notes, f"{int(np.count_nonzero(others))} {raw.rows}s that hold other columns alone are skipped.")
        raw, channels = _at(raw, ~others), [(name, y[~others], most) for name, y, most in channels]
    if drop_nan:
        whole = ~np.any([np.isnan(y) for _, y, _ in channels], axis=0)
        if not whole.all():
            dropped = int(np.count_nonzero(~whole))
            notes = (*notes, f"{dropped} {raw.rows}s without a value are skipped (--drop-nan).")
            raw, channels = _at(raw, whole), [(name, y[whole], most) for name, y, most in channels]
    for name, y, most in channels:
        bad = np.flatnonzero(~(np.abs(y) <= most))
        if bad.size:
            value = float(y[bad[0]])
            found = "no value or nan" if np.isnan(value) else f"{value:g}"
            accepted = "try: --drop-nan" if np.isnan(value) else f"at most {most:g} in size"
            raise InputError(f"{file}: {raw.rows} {bad[0] + 1}, {name}", found, accepted)
    return replace(raw, notes=notes)


def _at(raw: Raw, rows: BoolArray | IntArray) -> Raw:
    """These rows alone."""
    fields: Fields = {kind: {joint: y[rows] for joint, y in of.items()} for kind, of in raw.fields.items()}
    return replace(raw, t=raw.t[rows], fields=fields)


def _in_order(raw: Raw, file: str) -> Raw:
    """Times that increase: repeats are dropped and counted, one that goes back is refused."""
    steps = np.diff(raw.t)
    back = np.flatnonzero(steps < 0.0)
    if back.size:
        i = int(back[0])
        found = f"time {raw.t[i + 1]:.9g} s goes back from {raw.t[i]:.9g} s"
        raise InputError(f"{file}: {raw.rows} {i + 2}, t", found, "times that increase")
    again = steps == 0.0
    if not again.any():
        return raw
    every = [y for of in raw.fields.values() for y in of.values()]
    same = again & np.all([(y[1:] == y[:-1]) | (np.isnan(y[1:]) & np.isnan(y[:-1])) for y in every], axis=0)
    count, alike = int(again.sum()), int(same.sum())
    others = "" if alike == count else f" ({count - alike} with other values, of which the first is kept)"
    said = f"{count} of {raw.t.size} {raw.rows}s repeat the stamp of the one before{others}: dropped."
    kept = _at(raw, np.concatenate([[True], ~again]))
    return replace(kept, notes=(*raw.notes, said))


def _cut(raw: Raw, file: str, options: LogOptions) -> Raw:
    """What lies between --from and --to."""
    if options.start is None and options.stop is None:
        return raw
    inside = np.ones(raw.t.size, dtype=np.bool_)
    inside &= raw.t >= (-np.inf if options.start is None else options.start)
    inside &= raw.t <= (np.inf if options.stop is None else options.stop)
    if not inside.any():
        runs = f"the log runs from {raw.t[0]:g} s to {raw.t[-1]:g} s" if raw.t.size else "the log is empty"
        raise InputError(file, f"0 samples between --from and --to ({runs})", "a part that holds some")
    return _at(raw, inside)


_TURN = 4096.0
"""Steps of a turn of every such motor."""
_FIELDS: tuple[Field, ...] = ("position", "goal", "velocity")
_GRIPPER = "gripper"
_ACCEPTED = 'a calibration as LeRobot keeps it, {"elbow_flex": {"range_min": 805, "range_max": 3100, ..}, ..}'


def calibrated(raw: Raw, path: Path | None) -> Raw:
    """Angles in rad from the middle of each joint's calibrated range. Raises InputError for a file that is none, and
    for a log whose joints it has not."""
    if path is None:
        return raw
    ranges = _ranges(path)
    have = list(raw.fields.get("position", {}))
    if missing := [joint for joint in have if joint not in ranges]:
        raise InputError(str(path), f"no {', '.join(missing)}, but {', '.join(ranges)}", "the log's own")
    fields = dict(raw.fields)
    for kind in _FIELDS:
        of = fields.get(kind, {})
        shift = {joint: 50.0 if joint == _GRIPPER and kind != "velocity" else 0.0 for joint in of}
        scale = {joint: ranges[joint] / (100.0 if joint == _GRIPPER else 200.0) for joint in of}
        fields[kind] = {joint: (y - shift[joint]) * scale[joint] for joint, y in of.items()}
    said = (
        f"Positions are read as shares of the ranges in {path.name} (--calibration), -100 to 100 (a gripper's 0 to"
        " 100), and are angles from the middle of these."
    )
    told = dict(raw.told)
    told |= {kind: SI_UNITS[kind] for kind in _FIELDS if fields.get(kind)}
    return replace(raw, fields={k: of for k, of in fields.items() if of}, told=told, notes=(*raw.notes, said))


def _ranges(path: Path) -> Mapping[str, float]:
    """Angle of the whole range by joint, rad."""
    try:
        told: Any = parse_json(read_bytes(path, MOST_DOCUMENT_BYTES))
        turns = {str(name): (float(one["range_max"]) - float(one["range_min"])) / _TURN for name, one in told.items()}
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(str(path), f"unreadable ({type(error).__name__}: {error})", _ACCEPTED) from None
    if bad := [name for name, size in turns.items() if not 0.0 < size <= 1.0]:
        raise InputError(str(path), f"the range of {bad[0]} is not within one turn", _ACCEPTED)
    return {name: 2.0 * math.pi * size for name, size in turns.items()}
