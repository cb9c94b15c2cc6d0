"""A search for what breaks a reader, steered by the branches of our own code: ``python -m benchmarks.fuzz``.

An input that reaches a pair of lines which none before has reached is kept and changed further. Files that the program
reads in this process must give an answer or an error for people, within 5 s and 2 GiB; what it reads in a process of
its own may crash here, and is then read as the program reads it. Inputs are tried in children: a crash is an answer.
--keep writes those that reach all branches into seeds/, from which the next search begins.
"""

import argparse
import base64
import json
import os
import random
import resource
import signal
import struct
import sys
import tempfile
import time
import zlib
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType
from typing import Any

from mutations import NUMBERS, Change, applied, spots

from benchmarks.fuzz.targets import NAMES, TARGETS, Target
from harness.core.errors import HarnessError

ROOT = Path(__file__).resolve().parents[2]
SEEDS = ROOT / "tests" / "fuzz" / "seeds"
OURS = tuple(str(ROOT / "harness" / place) for place in ("io", "core", "model", "robot", "proof", "app"))
HANG_S, MEMORY = 5.0, 2 << 30
BATCH = 100
LONGEST = 200_000
"""Bytes of an input that is changed further."""
Branch = tuple[str, int, int]


def reached(target: Target, path: Path) -> tuple[set[Branch], str]:
    """Branches of ours that reading takes, and what is wrong with how it ended ("" for nothing)."""
    found: set[Branch] = set()

    def tracer(frame: FrameType, event: str, arg: Any) -> Any:
        name = frame.f_code.co_filename
        if not name.startswith(OURS):
            return None
        before = frame.f_code.co_firstlineno

        def local(frame: FrameType, event: str, arg: Any) -> Any:
            nonlocal before
            if event == "line":
                found.add((name, before, frame.f_lineno))
                before = frame.f_lineno
            return local

        return local

    sys.settrace(tracer)
    try:
        target.call(path)
    except HarnessError as error:
        sys.settrace(None)
        text = str(error)
        good = text.isprintable() and len(text) < 2000 and text.count("; ") >= 1
        return found, "" if good or target.apart else f"no line for people: {text!r}"
    except BaseException as error:
        sys.settrace(None)
        return found, answered(target, path) if target.apart else f"{type(error).__name__}: {error}"
    finally:
        sys.settrace(None)
    return found, ""


def answered(target: Target, path: Path) -> str:
    """What is wrong with what the program makes of a file that its reader fell over; "" for nothing."""
    try:
        target.whole(path)
    except HarnessError as error:
        return "" if str(error).isprintable() else "no line for people"
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    return ""


def changed(chance: random.Random, data: bytes, target: Target, others: Sequence[bytes]) -> bytes:
    """One to five changes, or a part of another input."""
    if chance.random() < 0.1 and others:
        other = chance.choice(others)
        return data[: chance.randrange(len(data) + 1)] + other[chance.randrange(len(other) + 1) :]
    places = spots(data) if target.apart else range(len(data) + 1)
    changes: list[Change] = []
    for _ in range(chance.choice((1, 1, 2, 3, 5))):
        place = chance.choice(places) if places else 0
        kind = chance.choice(
            ("number", "insert", "remove", "repeat", "cut") if target.texts else ("number",) * 6 + ("cut",)
        )
        if kind == "number" and target.texts and chance.random() < 0.5:
            text = bytes([chance.randrange(32, 127)])
        elif kind == "insert":
            text = chance.choice(target.texts)
        else:
            form = chance.choice(("<B", "<H", "<I", "<Q", ">I"))
            text = struct.pack(form, chance.choice(NUMBERS) & ((1 << 8 * struct.calcsize(form)) - 1))
        changes.append((kind, place, chance.choice((1, 1, 2, 4, 8, 64, 512)), text))
    return applied(data, changes)


@dataclass(slots=True)
class Search:
    """The search of one reader. kept : inputs that reached something new. wrong : inputs that broke it, and how."""

    name: str
    seed: int
    tried: int = 0
    seen: set[Branch] = field(default_factory=set)
    kept: list[bytes] = field(default_factory=list)
    wrong: dict[bytes, str] = field(default_factory=dict)
    crashed: int = 0

    def run(self, seconds: float) -> None:
        """Try the seeds, then changes of what is kept, for so long."""
        target, until = TARGETS[self.name], time.monotonic() + seconds
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / NAMES.get(self.name, f"fuzzed{target.suffix}")
            first = [*target.seeds, *stored(self.name)]
            for data in target.seeds:  # what is loaded late is loaded once, and not by every child
                path.write_bytes(data)
                with suppress(HarnessError):
                    target.call(path)
            while first or time.monotonic() < until:
                batch, first = (first[:BATCH], first[BATCH:]) if first else (None, first)
                self._batch(target, path, batch, until)

    def _batch(self, target: Target, path: Path, batch: list[bytes] | None, until: float) -> None:
        chance = random.Random(f"{self.seed} {self.tried}")
        ours, theirs = os.pipe()
        child = os.fork()
        if child == 0:
            os.close(ours)
            self._child(target, path, batch, until, chance, theirs)
        os.close(theirs)
        with os.fdopen(ours, "rb") as stream:
            lines = stream.read().splitlines()
        _, status = os.waitpid(child, 0)
        for line in lines:
            said = json.loads(line)
            self.tried += 1
            data = base64.b64decode(said["data"])
            new = {tuple(branch) for branch in said["new"]} - self.seen
            if new:
                self.seen |= new
                if len(data) <= LONGEST:
                    self.kept.append(data)
            if said["wrong"]:
                self.wrong[data] = said["wrong"]
        if status:
            self._ended(target, path, os.waitstatus_to_exitcode(status))

    def _ended(self, target: Target, path: Path, code: int) -> None:
        """A child that did not get to its end: the last input ended it."""
        self.tried += 1
        self.crashed += 1
        if not target.apart:
            self.wrong[path.read_bytes()] = f"ended the process ({code})"
            return
        if wrong := answered(target, path):
            self.wrong[path.read_bytes()] = wrong

    def _child(
        self, target: Target, path: Path, batch: list[bytes] | None, until: float, chance: random.Random, out: int
    ) -> None:
        """Try inputs, each said in a line; never returns."""
        code = 1
        try:
            used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
            resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, used + MEMORY))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            with os.fdopen(out, "wb") as stream:
                for data in batch or self._drawn(target, chance, until):
                    path.write_bytes(data)
                    signal.setitimer(signal.ITIMER_PROF, 4.0 * HANG_S)  # tracing takes time: ends the process
                    began = time.process_time()
                    new, wrong = reached(target, path)
                    if time.process_time() - began > HANG_S and not target.apart and not wrong:
                        wrong = self._slow(target, path)
                    signal.setitimer(signal.ITIMER_PROF, 0.0)
                    said = {"new": sorted(new - self.seen), "wrong": wrong, "data": base64.b64encode(data).decode()}
                    if not said["new"] and not wrong:
                        said["data"] = ""
                    self.seen |= new
                    stream.write(json.dumps(said).encode() + b"\n")
            code = 0
        finally:
            os._exit(code)

    def _slow(self, target: Target, path: Path) -> str:
        """Whether an input takes too long without being traced."""
        began = time.process_time()
        with suppress(HarnessError):
            target.call(path)
        took = time.process_time() - began
        return f"takes {took:.1f} s" if took > HANG_S else ""

    def _drawn(self, target: Target, chance: random.Random, until: float) -> Iterator[bytes]:
        pool = self.kept or list(target.seeds)
        for _ in range(BATCH):
            if time.monotonic() > until:
                return
            # what was found last reaches furthest
            data = pool[-1 - min(int(chance.expovariate(4.0 / len(pool))), len(pool) - 1)]
            yield changed(chance, data, target, pool)


def stored(name: str) -> list[bytes]:
    """Inputs that earlier searches have kept."""
    file = SEEDS / f"{name}.json"
    return [zlib.decompress(base64.b85decode(text)) for text in json.loads(file.read_text())] if file.exists() else []


def keep(search: Search, most: int = 20_000) -> None:
    """Write the small inputs that were kept, as text, and whatever broke the reader."""
    found = [*search.wrong, *(data for data in search.kept if data not in TARGETS[search.name].seeds)]
    texts = [base64.b85encode(zlib.compress(data, 9)).decode() for data in found if len(data) <= most]
    texts = [text for text in texts if len(text) <= 4000]
    (SEEDS / f"{search.name}.json").write_text(json.dumps(texts, indent=0) + "\n")


def main() -> int:
    """Search, and say of each reader what was found; exit code 1 when something broke."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--seconds", type=float, default=60.0, help="for each reader")
    parser.add_argument("--seed", type=int, default=int(time.time()))
    parser.add_argument("--keep", action="store_true", help="write what was kept into seeds/")
    parser.add_argument("readers", nargs="*", metavar="READER", help=", ".join(TARGETS))
    given = parser.parse_args()
    broken = False
    for name in given.readers or TARGETS:
        search = Search(name, given.seed)
        search.run(given.seconds)
        line = f"{name}: {search.tried} inputs, {len(search.seen)} branches, {len(search.kept)} kept"
        print(
            f"{line}, {search.crashed} ended their process, {len(search.wrong)} wrong (seed {given.seed})", flush=True
        )
        for data, why in search.wrong.items():
            broken = True
            print(f"  {why}\n    {base64.b85encode(zlib.compress(data, 9)).decode()[:3000]}", flush=True)
        if given.keep:
            keep(search)
    return int(broken)
