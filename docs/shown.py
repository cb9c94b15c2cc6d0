"""Writes what commands print into the pages that show them: python docs/shown.py [PAGE.md ...].

A page shows a command as a block of ``console`` that begins with "$ harness"; what follows it up to the next command or
the end of the block is what it prints. Files that a page shows under their name (`` `mine.py`: ``) are there when its
commands run, and so are the recording of the example and the model of the arm. One in a block of ``sh`` is not run. One
behind "! " is refused, as in a shell, and what it says is shown.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import textwrap
from pathlib import Path

DOCS = Path(__file__).resolve().parent
PAGES = (
    "start.md",
    "own-recording.md",
    "own-simulation.md",
    "robot-example.md",
    "robot-plan.md",
    "words.md",
    "own-scene.md",
    "robot-servo.md",
    "verdicts.md",
    "own-engine.md",
    "tune.md",
)
GIVEN = (DOCS / "example" / "rig.csv", DOCS.parent / "models" / "arm" / "arm.xml")
_BLOCK = re.compile(r"(?<=^```console\n)\$ .*?(?=^```$)", re.MULTILINE | re.DOTALL)
_FILE = re.compile(r"^`(\S+\.\w+)`:\n\n```\w+\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_ELSEWHERE = re.compile(r"^(report|trajectory): |^(what was found|- For that it) costs ")
"""Lines of paths, and of times that are another machine's."""
_WIDTH = 110


def text(page: str) -> str:
    """A page of docs with what its commands print now. SystemExit for a command that fails."""
    shown = (DOCS / page).read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        for file in GIVEN:
            shutil.copy(file, folder)
        for name, content in _FILE.findall(shown):
            (Path(folder) / name).write_text(content, encoding="utf-8")
        return _BLOCK.sub(lambda block: _again(block[0], Path(folder)), shown)


def _again(block: str, folder: Path) -> str:
    """The commands of a block, each with what it prints."""
    commands = [line[2:] for line in block.splitlines() if line.startswith("$ ")]
    return "".join(f"$ {command}\n{_run(command, folder)}" for command in commands)


def _run(command: str, folder: Path) -> str:
    """What a command prints, without what is another machine's."""
    refused = command.startswith("! ")
    program, *words = shlex.split(command.removeprefix("! "))
    environment = {**os.environ, "COLUMNS": str(_WIDTH), "NO_COLOR": "1", "PYTHONIOENCODING": "utf-8"}
    call = [sys.executable, *(["-m", "harness.cli"] if program == "harness" else []), *words]
    ended = subprocess.run(call, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if (ended.returncode > 1) is not refused:  # 1: a check failed, which it says
        raise SystemExit(f"{command}: {ended.stderr}")
    said = textwrap.fill(ended.stderr, _WIDTH) if refused else ended.stdout
    return "".join(f"{line.rstrip()}\n" for line in said.splitlines() if not _ELSEWHERE.search(line))


if __name__ == "__main__":
    for name in sys.argv[1:] or PAGES:
        (DOCS / name).write_text(text(name), encoding="utf-8")
