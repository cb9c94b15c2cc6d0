"""Writes docs/own-recording.md by running what it shows: python docs/own_recording.py."""

import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

DOCS = Path(__file__).resolve().parent
TARGET = DOCS / "own-recording.md"
_COMMAND = re.compile(r"^\$ ((?:harness|python -m) .+)$", re.MULTILINE)
_ELSEWHERE = re.compile(r"^report: |\bit costs ")
"""Lines of paths, and of times that are another machine's."""
_WIDTH = 110

TEXT = """\
# Your own recording in ten minutes

Written by `python docs/own_recording.py`, which runs every command shown. Follow it with the recording of the example
([docs/example/rig.csv](example/rig.csv), made by [make.py](example/make.py)) or with yours.

## 1. What to record

Pull the slider away, let go, and record until it rests: ten half-cycles or more, 40 samples or more a period. One
channel is enough (`x` or `a`); two tell sensor effects from physics. The wait before the release and the rest at the
end may stay in, they are found. Irregular sampling and gaps are no harm. Do not filter and do not smooth: the noise
is what decides what can be told.

## 2. Let it be read

A header names columns and units: `t [s],x [mm],a [g]`. Names as people write them do too (`Time (s)`, `pos`,
`theta_deg`, `/joint_states/position[0]`): what was guessed is printed with the `--columns` that says the same. Where
yours says something else, say it on the command line:

| your file | what to add |
|---|---|
| columns `time` in ms, `enc` in counts of 0.004 mm | `--columns "t=time[ms],x=enc*0.004[mm]"` |
| no header, angle in the first column, 1 kHz | `--columns "x=#1[deg]" --rate 1000 --restoring pendulum` |
| lines of text before the numbers | `--skip-rows 12` |
| the hand is still on it until 0.4 s | `--from 0.4` |
| an axis without a spring, driven by a measured force | `--columns "t=t,x=q,u=tau[N]" --restoring none` |

A first look, with estimators that assume viscous and Coulomb friction and nothing else:

```console
$ harness identify rig.csv
```

Six methods, and they disagree by much more than their standard errors: something is missing from that model.

## 3. What is missing

```console
$ harness diagnose rig.csv --out diagnosed
```

The sentence at the top is the answer. `chi2 a point` says whether anything but noise is left: 1 is noise. The report
shows the recording against the simulation before and after, where the mismatch sits, and the whole catalogue by its
evidence; `trace.rrd` opens in the rerun viewer; `result.json` holds every number.

Three other answers are possible, and each is one:

- *Nothing is missing*: viscous and Coulomb friction explain the recording to its noise.
- *It does not explain it, and nothing of the catalogue does*: see the map of the force left over, `residual_map.csv`.
- *A name with alternatives*: the recording does not tell them apart; it says which recording would.

## 4. Use the model

The refined model runs in the reference and in both engines, and is there as MJCF and URDF:

```console
$ harness run --model diagnosed/model/model.json --out again
```

What an engine cannot say in its own attributes is applied as a force at every step; `diagnosed/model/not_said.txt`
lists what the exported MJCF (`slider.xml`) and URDF leave out.

## 5. When it goes wrong

| what you see | what it is |
|---|---|
| acceleration and position differ by a factor of 9.81 or 1000 | a unit: `a [g]`, `x [mm]` |
| fewer than three half-cycles | let it go from further away, or record earlier |
| an impulse at the very beginning | the hand: `--from` |
| the noise of the measured force shifts reversals | a force measured with less noise, or a faster motion |
| `unexplained` on a long recording | try a part: `--from 2 --to 8`; what is missing may act at one end only |
"""


def text() -> str:
    """The page with what its commands print."""
    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(DOCS / "example" / "rig.csv", folder)
        return filled(TEXT, Path(folder))


def filled(page: str, folder: Path) -> str:
    """A page, behind each command what it prints in a folder."""
    parts, end = [], 0
    for match in _COMMAND.finditer(page):
        parts += [page[end : match.end()], "\n", _run(match[1], folder)]
        end = match.end()
    return "".join((*parts, page[end:]))


def _run(command: str, folder: Path) -> str:
    """What a command prints, its folder left out, and what it took, which is another machine's."""
    first, *words = shlex.split(command)
    environment = {**os.environ, "COLUMNS": str(_WIDTH), "NO_COLOR": "1", "PYTHONIOENCODING": "utf-8"}
    call = [sys.executable, "-m", "harness.cli", *words] if first == "harness" else [sys.executable, *words]
    ended = subprocess.run(call, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if ended.returncode != 0:
        raise SystemExit(f"{command}: {ended.stderr}")
    lines = [line.rstrip() for line in ended.stdout.splitlines() if not _ELSEWHERE.search(line)]
    return "\n".join(lines)


if __name__ == "__main__":
    TARGET.write_text(text(), encoding="utf-8")
