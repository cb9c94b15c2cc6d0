"""What a log holds, topic by topic."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from harness.core.apart import read_apart
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.io.logs import bags, lerobot
from harness.io.logs.finish import Finished, Gain, finished
from harness.io.logs.raw import LogOptions, Raw
from harness.io.logs.read import (
    Source,
    bag_topic,
    bag_topics,
    checked_source,
    raw_of_source,
    topic_of,
)
from harness.io.logs.rules import CHANNEL, SI_UNITS, Field
from harness.io.times import GAP
from harness.io.units import parse_unit

FIELDS: tuple[Field, ...] = ("position", "velocity", "effort", "current", "magnitude")


@dataclass(frozen=True, slots=True)
class TopicInfo:
    """What one topic holds.

    kind : its type in the bag, "table" or "episode". count : of messages or rows. rate_hz : by the median interval,
    None where no times are read. joints, fields : that are logged. units : taken for each field. gaps_s : [from, to].
    ranges : by joint and field, from the least to the largest, in these units.
    notes : what is odd about it, a sentence each.
    """

    name: str
    kind: str
    count: int
    rate_hz: float | None = None
    joints: tuple[str, ...] = ()
    fields: tuple[str, ...] = ()
    units: Mapping[Field, str] = field(default_factory=dict)
    gaps_s: tuple[tuple[float, float], ...] = ()
    ranges: Mapping[str, Mapping[Field, tuple[float, float]]] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


def describe_log(path: Path, options: LogOptions, gain: Gain | None = None) -> list[TopicInfo]:
    """Every topic of a bag, every episode of a data set, or the one topic that a table is; that which --topic names.

    Raises InputError for a file that cannot be read, or a table without joints.
    """
    try:
        source = checked_source(path, options, gain)
        of = {"bag": _bag, "lerobot": _data_set}.get(source.kind, _table)
        return list(of(source, options, gain))
    except OSError as error:
        raise InputError(str(path), error.strerror or str(error), "a file that can be read is accepted") from None


def _table(source: Source, options: LogOptions, gain: Gain | None) -> Iterator[TopicInfo]:
    raw = raw_of_source(source, options)
    yield _looked(source.path.name, "table", raw, str(source.path), options, gain)


def _bag(source: Source, options: LogOptions, gain: Gain | None) -> Iterator[TopicInfo]:
    topics = bag_topics(source)
    if options.topic is not None:
        topics = [topic_of(source, topics, options.topic)]
    for name, kind, count in topics:
        if kind != bags.TYPE or not count:
            yield TopicInfo(name, kind, count)
            continue
        try:
            raw = bag_topic(source, name, options)
        except InputError as error:
            yield TopicInfo(name, kind, count, notes=(f"It cannot be read: {error}.",))
            continue
        yield _looked(name, kind, raw, str(source.path), options, gain)


def _data_set(source: Source, options: LogOptions, gain: Gain | None) -> Iterator[TopicInfo]:
    """Episodes by their stamps; what their rows are like, by the first."""
    accepted = "a whole LeRobot data set is accepted"
    read = "harness.io.logs.lerobot:episodes_apart"
    stamps, _ = read_apart(read, source.path, accepted, seconds=source.seconds)
    first = lerobot.asked(options.topic) or next(iter(stamps), "0")
    raw = raw_of_source(source, replace(options, topic=first))
    like = _looked(f"episode {first}", "episode", raw, str(source.path), options, gain)
    yield like
    for name, t in stamps.items() if options.topic is None else ():
        if name != first:
            shape = like.joints, like.fields, like.units
            yield TopicInfo(f"episode {name}", "episode", t.size, _rate(t), *shape, _gaps(t))


def _looked(name: str, kind: str, raw: Raw, file: str, options: LogOptions, gain: Gain | None) -> TopicInfo:
    """What a log shows when it is read; a value that would end the reading is said, and its rows are left out."""
    notes: tuple[str, ...] = ()
    try:
        found = finished(raw, file, options, gain)
    except InputError as error:
        if error.where.startswith("--") or file not in error.where or "--gain" in error.where:
            raise
        notes = (f"{error}.",)
        try:
            found = finished(raw, file, LogOptions(drop_nan=True), None)
        except InputError:
            found = Finished(raw.t, {}, {}, {}, {}, raw.notes)
    held = {"position": found.position, "velocity": found.velocity, "effort": found.effort, **found.beside}
    fields = tuple(kind for kind in FIELDS if held.get(kind))
    told = {**raw.told, **({"magnitude": raw.told.get("effort", "")} if "magnitude" not in raw.told else {})}
    units = {kind: (told.get(kind) or SI_UNITS[kind]).replace("*", " ") for kind in fields}
    joints = tuple(raw.fields.get("position", {}))
    ranges: dict[str, dict[Field, tuple[float, float]]] = {}
    for what in fields:
        factor = parse_unit(what, CHANNEL[what], told.get(what) or None).factor
        for joint, values in held[what].items():
            known = values[np.isfinite(values)]  # of what is not read on, currents, nothing is checked
            if known.size:
                ranges.setdefault(joint, {})[what] = float(known.min()) / factor, float(known.max()) / factor
    shape = joints, fields, units, _gaps(found.t), ranges
    return TopicInfo(name, kind, raw.t.size, _rate(found.t), *shape, (*notes, *found.notes))


def _rate(t: FloatArray) -> float | None:
    """Hz, by the median interval; None where there is none."""
    median = float(np.median(np.diff(t))) if t.size > 1 else 0.0
    return 1.0 / median if np.isfinite(median) and median > 0.0 else None


def _gaps(t: FloatArray) -> tuple[tuple[float, float], ...]:
    """Where more time lies between samples than five medians."""
    steps = np.diff(t)
    if not steps.size:
        return ()
    return tuple((float(t[i]), float(t[i + 1])) for i in np.flatnonzero(steps > GAP * np.median(steps)))
