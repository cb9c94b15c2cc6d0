"""A diagnosis that looks for the answers instead of at the recording: files, arguments, environments of processes.

It is told more than any diagnosis is: where the proof is, and where temporary files and the home folder are.
"""

import hashlib
import json
import os
import re
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

PLACES: list[str] = []
"""Folders to look in; a copy of this file has them written in here."""
RECENT_S, LARGEST = 300.0, 5_000_000


def files() -> Iterator[Path]:
    """Files of the last minutes, in every place."""
    for place in PLACES:
        for folder, _, names in os.walk(place):
            for name in names:
                path = Path(folder) / name
                with suppress(OSError):
                    about = path.stat()
                    if about.st_size < LARGEST and time.time() - about.st_ctime < RECENT_S:
                        yield path


def texts() -> Iterator[str]:
    """Everything that can be read: files, and what processes were started with."""
    yield " ".join(sys.argv)
    yield json.dumps(dict(os.environ))
    for path in files():
        with suppress(OSError):
            yield f"{path}\n" + path.read_bytes().decode(errors="replace")
    for process in Path("/proc").glob("[0-9]*"):
        for name in ("cmdline", "environ"):
            with suppress(OSError):
                yield (process / name).read_bytes().decode(errors="replace").replace("\0", "\n")


def own() -> Iterator[str]:
    """The transcripts of the first place, where the proof is."""
    for path in Path(PLACES[0]).glob("*.json"):
        yield path.read_text()


def looked_up(recording: bytes) -> tuple[list[str], int]:
    """Names of effects found beside the name of this recording, and how many texts were seen."""
    seen = list(texts())
    about = hashlib.sha256(recording).hexdigest()
    # the transcript says which name a recording of this hash has
    names = {found for text in seen for found in re.findall(rf'"([0-9a-f]{{16}})": {{\s*"recording": "{about}"', text)}
    guesses: list[str] = []
    for name in names:
        for text in seen:
            for found in re.finditer(rf'{name}"(?:(?!"mechanisms").){{0,2000}}"mechanisms": \[([^\]]*)\]', text, re.S):
                guesses += re.findall(r'"([a-z-]+)"', found[1])
    # a seed would do as well, since everything follows from it: the one that the transcript commits to
    everything = "\n".join(seen)
    for value, salt in set(re.findall(r'"seed":\s*{\s*"value":\s*(\d+),\s*"salt":\s*"([0-9a-f]+)"', everything)):
        commitment = hashlib.sha256(f"{salt}{value}".encode()).hexdigest()
        guesses += ["seed"] if any(f'"commitment": "{commitment}"' in text for text in own()) else []
    return guesses, len(seen)


def main() -> None:
    while line := sys.stdin.buffer.readline():
        recording = sys.stdin.buffer.read(json.loads(line)["bytes"])
        guesses, seen = looked_up(recording)
        said = json.dumps(
            {"verdict": "missing_physics", "mechanisms": [{"name": g} for g in guesses], "statement": str(seen)},
            sort_keys=True,
            separators=(",", ":"),
        ).encode()
        sys.stdout.buffer.write(b"%d\n" % len(said) + said)
        sys.stdout.buffer.flush()


if __name__ == "__main__":
    main()
