"""LeRobot data sets: tables in data/, with a list a row for all joints, and their names in meta/info.json."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.apart import Found
from harness.core.arrays import FloatArray
from harness.core.bounded import MOST_DOCUMENT_BYTES, parse_json, read_bytes
from harness.core.errors import InputError
from harness.io.logs.raw import LogOptions, Raw, named, one_of
from harness.io.logs.tables import raw_of
from harness.io.readers.binary import ParquetTable

INFO = "meta/info.json"
_FIELDS = {
    "observation.state": "position",
    "observation.velocity": "velocity",
    "observation.effort": "effort",
    "observation.current": "current",
    "action": "goal",
}
"""What the lists of a data set are."""
EPISODE = "episode_index"


def root_of(path: Path) -> Path | None:
    """The folder of the data set that ``path`` is, or belongs to; None where it is none."""
    folders = [path] if path.is_dir() else list(path.absolute().parents)[:3]
    return next((folder for folder in folders if (folder / INFO).is_file()), None)


def files_of(path: Path) -> list[Path]:
    """The tables of a data set, or the one file."""
    if path.is_file():
        return [path]
    found = sorted((path / "data").glob("*/*.parquet"))
    if not found:
        raise InputError(str(path), "no data/*/*.parquet in it", "a LeRobot data set with its tables")
    return found


def columns_of(path: Path, options: dict[str, Any]) -> Found:
    """What ``raw_of_episode`` finds, as a process of its own hands it on."""
    return raw_of_episode(path, LogOptions(**options)).found()


def episodes_apart(path: Path) -> Found:
    """The stamps of every episode by its number, as a process of its own hands them on."""
    found: dict[str, FloatArray] = {}
    for file in files_of(path):
        table = ParquetTable(file)
        episodes, stamps = table.read([table.position(EPISODE), table.position("timestamp")])
        found |= {f"{episode:.0f}": stamps[episodes == episode] for episode in np.unique(episodes)}
    return found, None


def raw_of_episode(path: Path, options: LogOptions) -> Raw:
    """One episode: the one that --topic names, or the only one. Raises InputError that lists those there are."""
    called = _names(path)
    where: dict[str, tuple[Path, FloatArray]] = {}
    for file in files_of(path):
        table = ParquetTable(file, called)
        (episodes,) = table.read([table.position(EPISODE)])
        where |= {f"{episode:.0f}": (file, episodes) for episode in np.unique(episodes)}
    number = asked(options.topic)
    if number is None and len(where) > 1:
        found = f"{len(where)} episodes and no --topic"
        names = list(where)
        listed = ", ".join(names) if len(names) <= 4 else f"{names[0]}, {names[1]} to {names[-1]}"
        raise InputError(str(path), found, f"--topic with one of {listed}")
    number = next(iter(where), "0") if number is None else number
    if number not in where:
        raise one_of(str(path), number, list(where), "episode")
    file, episodes = where[number]
    table = ParquetTable(file, called)
    table.keep = episodes == float(number)
    return raw_of(table, LogOptions(columns=options.columns, rate=options.rate, angle_unit=options.angle_unit))


def asked(topic: str | None) -> str | None:
    """The number of the episode that --topic names, "3" or "episode 3"; None where nothing is asked."""
    return None if topic is None else topic.lower().removeprefix("episode").strip()


def _names(path: Path) -> Mapping[str, Sequence[str]]:
    """Names of the elements of each list, as columns of a log are named; those of commands are kept apart."""
    root = root_of(path)
    if root is None:
        return {}
    try:
        features = parse_json(read_bytes(root / INFO, MOST_DOCUMENT_BYTES))["features"]
        return {
            column: [_called(str(name), field) for name in _flat(features[column].get("names"))]
            for column, field in _FIELDS.items()
            if column in features
        }
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        found = f"unreadable ({type(error).__name__}: {error})"
        raise InputError(str(root / INFO), found, "the info.json of a LeRobot data set") from None


def _flat(names: object) -> list[object]:
    """Names as a list, or as lists by kind ({"motors": [...]})."""
    if isinstance(names, Mapping):
        return [name for of in names.values() for name in (of if isinstance(of, list) else [of])]
    return list(names) if isinstance(names, list) else []


def _called(name: str, field: str) -> str:
    """The column of an element: "elbow.pos" says its field itself, "elbow" does not."""
    said = named(name)
    if said is not None and said.style == "named":
        return f"{said.joint}.{field if field == 'goal' else said.field}"
    return f"{name}.{field}"
