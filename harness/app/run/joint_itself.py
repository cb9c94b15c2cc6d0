"""The user's file itself, stepped by the engines, beside the reduced slider: where the two disagree, and why."""

import math
from collections.abc import Sequence
from pathlib import Path

from harness.core.errors import InputError
from harness.engines.base import Preset
from harness.results.run import AsItIsResult, JointScore, StopResult
from harness.robot.as_it_is import AsItIs, Gravity
from harness.robot.reduction import Reduced

_ALIKE = 0.1
"""Of the larger creep: what gravity's change along the way, and a solver that stops early, may make."""
_STILL = 1e-5
"""rad/s or m/s: slower is no creep that anybody sees."""
MUJOCO, PYBULLET = "mujoco", "pybullet"


def itself_in(
    own: AsItIs,
    file: Path,
    reduced: Reduced,
    gravity: Gravity,
    plan: Sequence[tuple[str, Preset]],
    scores: Sequence[JointScore],
    dt: float,
) -> list[AsItIsResult]:
    """One for MuJoCo, and where the file is a URDF one for each preset of PyBullet. dt : of the tuned preset, s."""
    found = []
    if any(name == MUJOCO for name, _ in plan):
        found.append(_in_mujoco(own, reduced, scores))
    if file.suffix == ".urdf":
        for name, preset in plan:
            if name == PYBULLET:
                found += _in_bullet(own, file, reduced, gravity, preset, dt)
    return found


def _in_mujoco(own: AsItIs, reduced: Reduced, scores: Sequence[JointScore]) -> AsItIsResult:
    beside = next((one for one in scores if (one.engine, one.preset) == (MUJOCO, "as-shipped")), None)
    return AsItIsResult(
        engine=MUJOCO,
        preset="as-shipped",
        version=own.version,
        dt_s=own.dt,
        friction=own.friction,
        break_away=own.break_away,
        switched_off=own.switched_off,
        gravity=own.gravity,
        damping=own.damping,
        load=own.load,
        pose=own.pose,
        creep=own.creep,
        stop=_stop(own),
        diverges_after=own.diverges,
        differs=None if beside is None else _differs(own, reduced, beside),
        notes=list(own.notes),
    )


def _stop(own: AsItIs) -> StopResult | None:
    if own.stop is None:
        return None
    stopped = math.isfinite(own.stop.time)
    return StopResult(
        speed=own.stop.v0,
        time_s=own.stop.time if stopped else None,
        exact_time_s=own.stop.exact_time,
        travel=own.stop.travel if stopped else None,
        exact_travel=own.stop.exact_travel,
    )


def _differs(own: AsItIs, reduced: Reduced, beside: JointScore) -> str | None:
    if own.creep is None or beside.creep is None:
        return None
    larger = max(abs(own.creep), abs(beside.creep))
    if larger < _STILL or abs(own.creep - beside.creep) <= _ALIKE * larger:
        return None
    unit, scale = ("mm/s", 1e3) if reduced.slides else ("deg/s", math.degrees(1.0))
    return (
        f"That is not what the reduced joint does in MuJoCo as shipped, {scale * beside.creep:.3g} {unit}, which has"
        f" {_why(own, own.creep < beside.creep)}."
    )


def _why(own: AsItIs, slower: bool) -> str:
    """What the reduced joint has not as the file has it; slower : the file is."""
    reasons = []
    if own.switched_off > 0.0:
        reasons.append("the friction that your file switches off")
    if own.break_away > own.friction:
        reasons.append("no bristle of a motor")
    if slower and own.damping + (own.servo_damping if own.stiffness <= 0.0 else 0.0) > 0.0:
        reasons.append("no damping beside friction")
    if slower and own.spring > 0.0:
        reasons.append("no spring of the joint")
    return " and ".join(reasons) or "not everything that your file says"


def _in_bullet(
    own: AsItIs, file: Path, reduced: Reduced, gravity: Gravity, preset: Preset, dt: float
) -> list[AsItIsResult]:
    try:
        from harness.robot.as_it_is_bullet import in_bullet

        found = in_bullet(file, reduced.joint, own, gravity, preset, dt)
    except (ImportError, InputError):  # its score says so
        return []
    return [
        AsItIsResult(
            engine=PYBULLET,
            preset="tuned" if preset == "tuned" else "as-shipped",
            version=found.version,
            dt_s=found.dt,
            friction=own.friction,
            break_away=own.friction,
            gravity=own.gravity,
            damping=own.damping,
            load=own.load,
            pose=own.pose,
            creep=found.creep,
            diverges_after=found.diverges,
        )
    ]
