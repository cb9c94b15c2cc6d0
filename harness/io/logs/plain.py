"""Logs in MCAP files that are no bags: which topics name positions, and one of them as a log."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from harness.core.apart import read_apart
from harness.core.errors import InputError
from harness.io.logs import messages
from harness.io.logs.bags import seconds_of
from harness.io.logs.raw import LogOptions, Raw, named, one_of
from harness.io.logs.tables import raw_of, time_of
from harness.io.table import held, table_of_arrays


def topics(path: Path) -> list[tuple[str, str, int, list[str]]]:
    """Name, schema, count and the numbers' names of every topic."""
    messages.need_mcap(path)
    seconds = seconds_of(path.stat().st_size)
    _, found = read_apart("harness.io.logs.messages:topics_of", path, messages.ACCEPTED, seconds=seconds)
    return [(str(name), str(kind), int(count), list(names)) for name, kind, count, names in found]


def positioned(names: Sequence[str]) -> bool:
    """Whether one of the names says the position of a joint."""
    return any(found is not None and found.field == "position" for found in map(named, names))


def of_topic(path: Path, topic: str, options: LogOptions) -> Raw:
    """The joints of one topic, its numbers taken as the columns of a table."""
    seconds, read = seconds_of(path.stat().st_size), "harness.io.logs.messages:columns_of"
    columns, names = read_apart(read, path, messages.ACCEPTED, seconds=seconds, topic=topic)
    table = table_of_arrays(path, {name: held(columns[name]) for name in names})
    logged = time_of(table)[0] is None and options.rate is None
    if logged:
        arrays = {"t": columns[messages.LOGGED], **{name: columns[name] for name in names}}
        table = table_of_arrays(path, {name: held(values) for name, values in arrays.items()})
    raw = replace(raw_of(table, options), rows="message")
    return replace(raw, notes=(*raw.notes, "Times are those of logging.")) if logged else raw


def chosen(path: Path, options: LogOptions) -> Raw:
    """The topic that --topic names, or the only one that names positions. Raises InputError that lists them."""
    there = topics(path)
    known = [name for name, _, _, names in there if positioned(names)]
    if options.topic is not None:
        every = [name for name, *_ in there]
        asked = next((name for name in every if name.lstrip("/") == options.topic.lstrip("/")), None)
        if asked is None:
            raise one_of(str(path), options.topic, every, "topic")
        return of_topic(path, asked, options)
    if len(known) > 1:
        found = f"{len(known)} topics with positions and no --topic"
        raise InputError(str(path), found, f"--topic with one of {', '.join(known)}")
    if not known:
        listed = ", ".join(f"{name} ({kind})" for name, kind, *_ in there[:8]) or "no topic"
        raise InputError(str(path), f"no topic that names positions, but {listed}", messages.ACCEPTED)
    return of_topic(path, known[0], options)
