"""A motion for a robot to be driven along, by which its joints' friction is told best: harness plan."""

import json
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from harness.app.shared.deliver import to_json
from harness.app.shared.leaving import leaving
from harness.app.shared.machine import this_machine
from harness.app.shared.progress import SILENT, Progress
from harness.core.arrays import FloatArray
from harness.core.checks import positive
from harness.core.errors import InputError
from harness.results.plan import PlannedJoint, PlanResult
from harness.robot.arm import load_arm
from harness.robot.plan import Limits, Motion, planned, random_motion

FILES = {"result": "result.json", "csv": "trajectory.csv", "ros": "trajectory.yaml", "lerobot": "lerobot"}
_RANDOM, _SEED, _LEAST = 20, 1, 4.0
"""Motions to compare with; s that a motion lasts at least: its beginning and end, and two reversals."""
_PER_SECOND = 50.0
"""Points of a ROS trajectory, whose controllers put splines through them."""
_FRAMES = 30
"""A second of a LeRobot data set, as its programs record and replay them."""


def plan(
    robot: Path,
    joints: Sequence[str] = (),
    seconds: float = 20.0,
    rate: float = 250.0,
    speed: float | None = None,
    torque: float | None = None,
    out: Path | None = None,
    progress: Progress = SILENT,
    command: str = "",
) -> PlanResult:
    """Plan a motion and leave it as CSV, a trajectory_msgs/JointTrajectory, and a LeRobot data set to be replayed.

    robot : MJCF or URDF. joints : those that move, all that can by themselves where none is named; the others rest as
    the model has them. rate : Hz of the CSV. speed : rad/s or m/s, and torque : N m or N, in place of the model's
    limits.

    Raises InputError for a joint that is none, for numbers that are not above 0, for a motion that is too short or that
    gravity does not allow; StoreError.
    """
    for name, value, unit in (("--seconds", seconds, "s"), ("--rate", rate, "Hz")):
        positive(name, value, unit)
    for name, limit, unit in (("--speed", speed, "rad/s"), ("--torque", torque, "N m")):
        if limit is not None:
            positive(name, limit, unit)
    if seconds < _LEAST:
        raise InputError("--seconds", f"{seconds:g} s", f"at least {_LEAST:g} s")
    arm = load_arm(robot)
    led = {arm.joints[tie.follows]: arm.joints[tie.leads] for tie in arm.ties}
    names = tuple(joints) or tuple(name for name in arm.joints if name not in {*arm.coupled, *led})
    for name in names:
        arm.index(name, "--joints")
        if name in led:
            raise InputError(f"--joints: {name}", f"it goes where {led[name]} takes it", led[name])
    limits = Limits.of(robot, arm, names, speed, torque)
    with leaving("plan", out) as output:
        rng = np.random.default_rng(_SEED)
        progress("random motions", 0, 3)
        others = [random_motion(arm, names, limits, seconds, rng) for _ in range(_RANDOM)]
        noise = np.maximum(np.median([other.torque() for other in others], axis=0), 1e-9)
        progress("the best motion", 1, 3)
        best = planned(arm, names, limits, seconds, noise)
        progress("writing", 2, 3)
        least = best.errors(noise)
        better = np.median([other.errors(noise) for other in others], axis=0) / least
        drawn = [random_motion(arm, names, limits, seconds, rng, largest=False).errors(noise) for _ in range(_RANDOM)]
        conditioned = min(others, key=lambda other: other.condition(noise)).errors(noise)
        _write(best, rate, output / FILES["csv"], output / FILES["ros"])
        _episode(best, output / FILES["lerobot"])
        result = PlanResult(
            robot=str(robot.absolute()),
            seconds=seconds,
            rate_hz=rate,
            joints=_joints(best, rate, better),
            better=_mean(better),
            better_than_drawn=_mean(np.median(drawn, axis=0) / least),
            better_than_conditioned=_mean(conditioned / least),
            notes=[
                *arm.notes,
                *limits.notes,
                "Whether links meet, or the ground, is not looked at: try it slowly first.",
            ],
            files={kind: output.at(name) for kind, name in FILES.items()},
            command=command,
            machine=this_machine(),
        )
        (output / FILES["result"]).write_text(to_json(result), encoding="utf-8")
    return result


def _mean(ratios: FloatArray) -> float:
    """Geometric."""
    return float(np.exp(np.mean(np.log(ratios))))


def _joints(best: Motion, rate: float, better: FloatArray) -> list[PlannedJoint]:
    _, q, v, _ = best.at(rate)
    torque, limits, found = best.torque(), best.limits, []
    for k, name in enumerate(best.joints):
        i = best.arm.index(name)
        own = [float(of[k]) for of in (limits.low, limits.high, limits.speed, limits.torque)]
        found.append(
            PlannedJoint(
                joint=name,
                slides=best.arm.slides(name),
                low=float(np.min(q[:, i])),
                high=float(np.max(q[:, i])),
                speed=float(np.max(np.abs(v[:, i]))),
                torque=float(torque[k]),
                limits=[x if math.isfinite(x) else None for x in own],
                better=better[k].tolist(),
            )
        )
    return found


def _write(best: Motion, rate: float, table: Path, ros: Path) -> None:
    """A table of positions, speeds and accelerations, and the same for a controller of ROS."""
    places = [best.arm.index(name) for name in best.joints]
    t, *motions = best.at(rate)
    columns = [y[:, i] for i in places for y in motions]
    names = [f"{name}.{what}" for name in best.joints for what in ("position", "velocity", "acceleration")]
    np.savetxt(table, np.column_stack((t, *columns)), "%.9g", ",", header=",".join(("t", *names)), comments="")
    t, *motions = best.at(_PER_SECOND)
    lines = [f"joint_names: [{', '.join(best.joints)}]", "points:"]
    for k, time in enumerate(t):
        own = [f"[{', '.join(f'{y[k, i]:.7g}' for i in places)}]" for y in motions]
        lines.append(f"- positions: {own[0]}\n  velocities: {own[1]}\n  accelerations: {own[2]}")
        lines.append(f"  time_from_start: {{sec: {int(time)}, nanosec: {round(1e9 * (time - int(time)))}}}")
    ros.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _episode(best: Motion, folder: Path) -> None:
    """One episode of actions in degrees (slides in m), in the layout of LeRobot's data sets of version 2.1."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    arm, turns = best.arm, [1.0 if best.arm.slides(name) else math.degrees(1.0) for name in best.joints]
    t, q, _, _ = best.at(_FRAMES)
    actions = (q[:, [arm.index(name) for name in best.joints]] * turns).astype(np.float32)
    frames, zeros = np.arange(t.size), np.zeros(t.size, dtype=np.int64)
    columns = {
        "action": pa.FixedSizeListArray.from_arrays(actions.ravel(), len(turns)),
        "timestamp": t.astype(np.float32),
        "frame_index": frames,
        "episode_index": zeros,
        "index": frames,
        "task_index": zeros,
    }
    kinds = {"timestamp": "float32", **dict.fromkeys(("frame_index", "episode_index", "index", "task_index"), "int64")}
    scalars = {name: {"dtype": kind, "shape": [1], "names": None} for name, kind in kinds.items()}
    action = {"dtype": "float32", "shape": [len(turns)], "names": [f"{name}.pos" for name in best.joints]}
    info = {
        "codebase_version": "v2.1",
        "total_episodes": 1,
        "total_frames": t.size,
        "total_tasks": 1,
        "total_chunks": 1,
        "chunks_size": 1000,
        "fps": _FRAMES,
        "splits": {"train": "0:1"},
        "data_path": "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet",
        "features": {"action": action, **scalars},
    }
    task = "to and fro within the limits"
    texts = {
        "info.json": info,
        "tasks.jsonl": {"task_index": 0, "task": task},
        "episodes.jsonl": {"episode_index": 0, "tasks": [task], "length": t.size},
    }
    for where in ("meta", "data/chunk-000"):
        (folder / where).mkdir(parents=True)
    for name, content in texts.items():
        (folder / "meta" / name).write_text(json.dumps(content) + "\n", encoding="utf-8")
    pq.write_table(pa.table(columns), folder / "data/chunk-000/episode_000000.parquet")
