"""A log of any format as a validated core JointLog, and what it holds, topic by topic."""

import hashlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.apart import read_apart
from harness.core.arrays import FloatArray
from harness.core.bounded import MOST_BYTES, check_file, check_size
from harness.core.checks import finite
from harness.core.errors import InputError
from harness.core.robot import JointLog
from harness.io.logs import bags, lerobot, plain
from harness.io.logs.finish import Finished, Gain, finished
from harness.io.logs.joined import joined
from harness.io.logs.messages import is_plain
from harness.io.logs.naming import renamed
from harness.io.logs.raw import CHANNEL, SI_UNITS, Field, LogOptions, Raw, from_found, one_of
from harness.io.logs.tables import raw_of, raw_of_file
from harness.io.readers.binary import PARQUET
from harness.io.registry import kind_of, reader_for
from harness.io.times import GAP
from harness.io.units import parse_unit


@dataclass(frozen=True, slots=True)
class Source:
    """What a path is. kind : bag, mcap (one that is no bag), lerobot or table. files : those that are read."""

    path: Path
    kind: str
    files: tuple[Path, ...]

    @property
    def sha256(self) -> str:
        """Of the file; of several, of their hashes one after the other."""
        hashes = []
        for file in self.files:
            with file.open("rb") as stream:
                hashes.append(hashlib.file_digest(stream, "sha256").hexdigest())
        return hashes[0] if len(hashes) == 1 else hashlib.sha256("".join(hashes).encode()).hexdigest()

    @property
    def seconds(self) -> int:
        """How long reading may take, s of a processor."""
        return bags.seconds_of(sum(file.stat().st_size for file in self.files))


def source_of(path: Path, several: bool = False) -> Source:
    """What a path is, by its folder and the first bytes of an .mcap. Raises InputError for what is no log.

    several : all files of a folder may be meant.
    """
    if is_plain(path):
        return Source(path, "mcap", (path,))
    if found := bags.storages(path):
        return Source(path, "bag", tuple(found))
    if path.is_dir() and lerobot.root_of(path) == path:
        return Source(path, "lerobot", tuple(lerobot.files_of(path)))
    check_file(path, accepted="a file, the folder of a ROS 2 bag, or that of a LeRobot data set", several=several)
    return Source(path, "lerobot" if kind_of(path) in PARQUET.suffixes and lerobot.root_of(path) else "table", (path,))


def read_joint_log(path: Path, *, gain: Gain | None = None, **options: Any) -> JointLog:
    """Read a log of a robot's joints, in SI units: a table, a LeRobot data set, a ROS bag.

    gain : N m per A at the joint, one or by joint. options : as of LogOptions; columns is for names that say nothing,
    "t=t,elbow.position=q3[deg],elbow.effort=7.1*cur3[N*m]". Repeated rows are dropped, an effort without a sign is left
    out; what was read and done is in the notes.

    Raises InputError naming the file, row, column, joint or option that is wrong.
    """
    asked = LogOptions(**options)
    with _readable(path):
        source = _checked_source(path, asked, gain)
        return finished(raw_of_source(source, asked), str(path), asked, gain).log(str(path), source.sha256)


@contextmanager
def _readable(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise InputError(str(path), error.strerror or str(error), "a file that can be read") from None


def _checked_source(path: Path, options: LogOptions, gain: Gain | None) -> Source:
    """What a path is, and the options looked at. Raises InputError for one that cannot be, or not for such a source."""
    for value in gain.values() if isinstance(gain, Mapping) else [] if gain is None else [gain]:
        if finite("--gain", value) == 0.0:
            raise InputError("--gain", "0", "N m per A, other than 0")
    source = source_of(path)
    if options.join and source.kind == "table":
        for other in options.join:
            check_file(other)
        source = replace(source, files=(path, *options.join))
    reader = reader_for(path) if source.kind == "table" else None
    unfit = {
        "--calibration": (options.calibration and source.kind == "bag", "tables and LeRobot data sets"),
        "--topic": (options.topic and source.kind == "table", "bags and LeRobot data sets"),
        "--join": (options.join and (reader is None or not reader.text), "text tables alone"),
        "--columns": (options.columns and source.kind == "bag", "tables"),
        "--rate": (options.rate and source.kind == "bag", "tables"),
        "--skip-rows": (options.skip_rows and (reader is None or not reader.text), "text tables alone"),
    }
    for option, (given, accepted) in unfit.items():
        if given:
            raise InputError(option, f"given for {path}", f"it goes with {accepted}")
    return source


def raw_of_source(source: Source, options: LogOptions) -> Raw:
    """What stands in a log, of what ``options`` choose."""
    path = source.path
    if source.kind == "bag":
        return _of_bag(source, options)
    if source.kind == "mcap":
        return plain.chosen(path, options)
    reader = reader_for(path)
    apart = "harness.io.logs.lerobot" if source.kind == "lerobot" else "harness.io.logs.tables"
    if source.kind == "table" and (reader is None or reader.text):
        for file in source.files:
            check_size(file, MOST_BYTES)
        if not options.join:
            return raw_of_file(path, options)
        table = joined(source.files, options.skip_rows)
        raw = raw_of(table, options)
        return replace(raw, notes=(*raw.notes, *table.mended))
    accepted = f"a whole {path.suffix or 'LeRobot'} file"
    found = read_apart(
        f"{apart}:columns_of",
        path,
        accepted,
        seconds=source.seconds,
        options=asdict(replace(options, calibration=None)),
    )
    return from_found(*found)


def bag_topics(source: Source) -> list[tuple[str, str, int]]:
    """Name, type and count of every topic of a bag."""
    bags.need_rosbags(source.path)
    _, found = read_apart("harness.io.logs.bags:topics_of", source.path, bags.ACCEPTED, seconds=source.seconds)
    return [(str(name), str(kind), int(count)) for name, kind, count in found]


def bag_topic(source: Source, topic: str, options: LogOptions) -> Raw:
    """The joint states of one topic; where its messages speak of several sets of joints, the fitting one."""
    read = "harness.io.logs.bags:columns_of"
    columns, about = read_apart(read, source.path, bags.ACCEPTED, seconds=source.seconds, topic=topic)
    sets = [number for number, found in enumerate(about) if found["joints"]]
    if not sets:
        raise InputError(f"{source.path}: {topic}", "no joint in any message", "a topic with joint states")
    # joints that --names renames count as wanted; those of no set are said when it is read
    wanted = set(options.joints or ())
    chosen = max(sets, key=lambda number: (len(wanted & _called(about[number]["joints"], options)), -number))
    mine = {k.partition(" ")[2]: v for k, v in columns.items() if k.partition(" ")[0] == str(chosen)}
    notes = list(about[chosen]["notes"])
    for number in sets:
        if number != chosen:
            names = ", ".join(about[number]["joints"][:4])
            notes.append(f"{about[number]['count']} messages speak of other joints ({names}): not used.")
    said = {"told": {}, "rows": "message", "numbered": about[chosen]["numbered"], "notes": notes}
    raw = from_found(mine, said)
    return raw if options.angle_unit is None else _turned(raw, options.angle_unit)


def _called(joints: list[str], options: LogOptions) -> set[str]:
    """What --names makes of joints, as far as it fits them."""
    with suppress(InputError):
        nothing: dict[str, FloatArray] = dict.fromkeys(joints, np.zeros(0))
        return set(renamed(Raw(np.zeros(0), {"position": nothing}), options.names, options.joints).fields["position"])
    return set(joints)


def _of_bag(source: Source, options: LogOptions) -> Raw:
    """The topic of a bag that --topic names, or the only one with joint states."""
    topics = bag_topics(source)
    if options.topic is not None:
        return bag_topic(source, topic_of(source, topics, options.topic)[0], options)
    known = [name for name, kind, count in topics if kind == bags.TYPE and count]
    if not known:
        there = ", ".join(f"{name} ({kind})" for name, kind, _ in topics[:8]) or "no topic"
        raise InputError(str(source.path), f"no joint states, but {there}", f"a topic of {bags.TYPE}")
    if len(known) > 1:
        found = f"{len(known)} topics of joint states and no --topic"
        raise InputError(str(source.path), found, f"--topic with one of {', '.join(known)}")
    return bag_topic(source, known[0], options)


def topic_of(source: Source, topics: list[tuple[str, str, int]], asked: str) -> tuple[str, str, int]:
    """The topic of joint states of this name, the first slash given or not. Raises InputError that lists them."""
    known = {topic[0]: topic for topic in topics if topic[1] == bags.TYPE and topic[2]}
    found = known.get(asked) or known.get(f"/{asked.lstrip('/')}")
    if found is None:
        raise one_of(str(source.path), asked, list(known), "topic of joint states")
    return found


def _turned(raw: Raw, unit: str) -> Raw:
    """Positions and velocities of a bag in another unit than its format says."""
    factor = parse_unit("--angle-unit", "x", unit).factor
    fields = dict(raw.fields)
    for kind in ("position", "velocity"):
        turned: dict[str, FloatArray] = {joint: factor * y for joint, y in raw.fields.get(kind, {}).items()}
        if turned:
            fields[kind] = turned
    told = {"position": unit, "velocity": f"{unit}/s"}
    return Raw(raw.t, fields, told, raw.rows, raw.numbered, (*raw.notes, f"Angles are read in {unit} (--angle-unit)."))


FIELDS: tuple[Field, ...] = tuple(CHANNEL)


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
    with _readable(path):
        source = _checked_source(path, options, gain)
        if source.kind == "bag":
            return list(_bag(source, options, gain))
        if source.kind == "mcap":
            return list(_messages(source, options, gain))
        if source.kind == "lerobot":
            return list(_data_set(source, options, gain))
        return [_looked(path.name, "table", raw_of_source(source, options), str(path), options, gain)]


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


def _messages(source: Source, options: LogOptions, gain: Gain | None) -> Iterator[TopicInfo]:
    for name, kind, count, names in plain.topics(source.path):
        if options.topic is None and not plain.positioned(names):
            yield TopicInfo(name, kind, count)
        elif options.topic is None or name.lstrip("/") == options.topic.lstrip("/"):
            raw = plain.of_topic(source.path, name, options)
            yield _looked(name, kind, raw, str(source.path), options, gain)


def _data_set(source: Source, options: LogOptions, gain: Gain | None) -> Iterator[TopicInfo]:
    """Episodes by their stamps; what their rows are like, by the first."""
    accepted = "a whole LeRobot data set"
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
            found = Finished(raw.t, {}, {}, {}, {}, raw.notes, "")
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
