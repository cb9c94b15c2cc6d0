"""Writes docs/robot-example.md by running what it shows: python docs/robot_example.py. It needs the extra bags."""

import runpy
import shutil
import tempfile
from pathlib import Path

DOCS = Path(__file__).resolve().parent
TARGET = DOCS / "robot-example.md"

TEXT = """\
# A robot's joint in ten minutes

Written by `python docs/robot_example.py`, which runs every command shown. The robot is a small arm of three joints,
[models/arm](../models/arm/arm.xml); take it, or your own model (MJCF or URDF) and a log of its joints. Copy `arm.xml`
to an empty folder and follow.

## 1. A log

Logs of this arm, with friction that we know and its model does not: base .6 N m and .2 N m s/rad, shoulder 1.1 and .4,
elbow .35 and .12. A servo follows sums of sines; positions and torques are noisy. ROS bags need
`pip install 'friction-harness[bags]'`; without it the same logs are there as CSV.

```console
$ python -m harness.robot.example logs
$ harness log logs/moving/moving.mcap
```

What to record on your own: positions and torques (or motor currents, with `--gain` in N m per A) of all joints, 20 s or
more, every joint to and fro at several speeds. `harness log` says what is odd about a log before you use it.

## 2. What your engine makes of the model as it is

```console
$ harness run --robot arm.xml --joint elbow --out before
```

A real joint under such a load stands still. `before/trace.rrd` shows the robot and its creep.

## 3. Its friction, from the log

```console
$ harness diagnose logs/moving/moving.mcap --robot arm.xml --joint elbow --out elbow
```

Friction comes back: .35 and .12 were put in. The last table is the proof: your model, driven by the torque of the
log in both engines, goes far from it as the file is, and stays with it once the line is pasted.
`elbow/model/arm.xml` is your file with that line in it and nothing else changed. `elbow/trace.rrd` shows the arm moving
as the log, with the torque that is left over speed and position; `elbow/report.html` is the same as a page.
`robot.arm` in `elbow/result.json` has the other joints.

## 4. Settings for your step

```console
$ harness tune mujoco --robot elbow/model/arm.xml --joint elbow
```

And what the engine makes of the copy:

```console
$ harness run --robot elbow/model/arm.xml --joint elbow --engine mujoco --out after
```

## 5. Many logs

`harness diagnose day-*.mcap --robot arm.xml --conditions days.csv` diagnoses each log, and says in which joints
friction is not the same in all, and whether it goes with temperature or whatever else `days.csv` has beside `file`.

## 6. When it goes wrong

| what you see | what it is |
|---|---|
| no effort of it is logged | currents: `--gain`; a magnitude without a sign says nothing of friction |
| the effort is hardly in N m | amperes, or the model of another robot |
| positions beyond two turns | degrees: `harness log --angle-unit deg` shows what they would be |
| it does not move to and fro enough | a log in which the joint reverses several times at more than walking pace |
| a scale of the torque or masses, one entry | no log can part them: `--gain`, `--payload`, `--sensor` do |

What stands behind each step: [robot.md](robot.md), [robot-logs.md](robot-logs.md), [whole-arm.md](whole-arm.md).
"""


def text() -> str:
    """The page with what its commands print."""
    filled = runpy.run_path(str(DOCS / "own_recording.py"))["filled"]
    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(DOCS.parent / "models" / "arm" / "arm.xml", folder)
        return str(filled(TEXT, Path(folder)))


if __name__ == "__main__":
    TARGET.write_text(text(), encoding="utf-8")
