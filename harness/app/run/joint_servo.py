"""What a time step does to the servo and the damping of a robot's joint, by the laws of docs/fidelity.md."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.engines.base import Preset
from harness.engines.mujoco.presets import INTEGRATORS
from harness.fidelity import laws
from harness.results.run import AsItIsResult, JointScore, ServoCure, ServoResult, ServoScore, StopResult
from harness.robot.as_it_is import AsItIs, Gravity
from harness.robot.reduction import Reduced

_SUBSTEPS = 4
"""Of an engine that divides a step, as Rapier and PhysX's TGS ship."""
_HALVINGS = 60
_DIGITS = 3


def servo_scores(own: AsItIs) -> ServoResult | None:
    """What the step does to the file's servo; None without one."""
    if own.stiffness <= 0.0 and own.servo_damping <= 0.0:
        return None
    m, k, h = own.inertia, own.stiffness + own.spring, own.dt
    c = own.damping + own.servo_damping
    held, parts = laws.held, laws.held_step
    rows: list[tuple[str, FloatArray, Callable[[], float]]] = [
        (f"MuJoCo, {own.integrator}, as the model has it", step_of(own), lambda: _by_mujoco(own)),
        ("a torque held over the step (PyBullet's TORQUE_CONTROL)", parts(m, c, k, h, 1), lambda: held(m, c, k, h, 1)),
        (
            f"a torque held over {_SUBSTEPS} sub-steps (Rapier, PhysX TGS)",
            parts(m, c, k, h, _SUBSTEPS),
            lambda: held(m, c, k, h, _SUBSTEPS),
        ),
        (
            "the engine's own implicit drive (DART, PhysX PGS)",
            laws.implicit_step(m, c, k, h, 1),
            lambda: laws.implicit(m, c, k, h, 1),
        ),
    ]
    root = 2.0 * math.sqrt(k * m)
    scores = []
    for who, step, law in rows:
        acting = None
        if laws.stable(step):
            try:
                acting = law()
            except ValueError:  # it is stable, and its speed turns round at every step: no damping does that
                acting = None
        zeta = None if acting is None or root == 0.0 else acting / root
        away = None if acting is None else acting - c
        scores.append(ServoScore(who=who, false_damping=away, zeta=zeta, stable=laws.stable(step)))
    diverges = not scores[0].stable or own.servo_diverges is not None
    return ServoResult(
        stiffness=own.stiffness,
        damping=c,
        zeta=c / root if root > 0.0 else None,
        step_s=h,
        scores=scores,
        diverges_after=own.servo_diverges,
        cure=cure(own) if diverges else None,
    )


def step_of(
    own: AsItIs,
    *,
    stiffness: float = 1.0,
    damping: float = 1.0,
    h: float | None = None,
    m: float | None = None,
    integrator: str | None = None,
) -> FloatArray:
    """What a step of MuJoCo makes of the joint with its servo; stiffness, damping : times the servo's own."""
    h, m, integrator = h or own.dt, m or own.inertia, integrator or own.integrator
    k, c = own.spring + stiffness * own.stiffness, own.damping + damping * own.servo_damping
    if integrator == "RK4":
        return laws.runge_kutta_step(m, c, k, h)
    if integrator == "discrete":
        return laws.implicit_step(m, c, k, h, 1)
    if integrator == own.integrator:
        # of the servo's damping, what is taken at the end is as much of it as it was
        end = max(own.at_end - own.damping, 0.0) * damping + min(own.at_end, own.damping)
    else:
        end = own.damping if integrator == "Euler" else c
    return laws.semi_implicit_step(m, c - end, end, k, h)


def _by_mujoco(own: AsItIs) -> float:
    """Damping that acts, N m s/rad or N s/m."""
    m, k, h, c = own.inertia, own.stiffness + own.spring, own.dt, own.damping + own.servo_damping
    if own.integrator == "RK4":
        return c
    if own.integrator == "discrete":
        return laws.implicit(m, c, k, h, 1)
    return laws.half_implicit(m, c - own.at_end, own.at_end, h)


def cure(own: AsItIs) -> ServoCure:
    """What makes it stable, one thing at a time, each as little as it takes; None where that alone does not."""
    k = _largest(lambda f: laws.stable(step_of(own, stiffness=f)))
    c = _largest(lambda f: laws.stable(step_of(own, damping=f)))
    h = _largest(lambda f: laws.stable(step_of(own, h=f * own.dt)))
    m = _largest(lambda f: laws.stable(step_of(own, m=own.inertia / f)))
    return ServoCure(
        stiffness=None if k is None or own.stiffness <= 0.0 else _down(k * own.stiffness),
        kp=None if k is None or own.kp is None else _down(k * own.kp),
        damping=None if c is None or own.servo_damping <= 0.0 else _down(c * own.servo_damping),
        step_s=None if h is None else _down(h * own.dt),
        armature=None if m is None else -_down(-own.inertia * (1.0 / m - 1.0)),
        integrators=[one for one in INTEGRATORS if one != own.integrator and laws.stable(step_of(own, integrator=one))],
    )


def _largest(stable: Callable[[float], bool]) -> float | None:
    """The largest factor up to 1 with which it is stable; None where it is with none."""
    low, high = 1e-9, 1.0
    if not stable(low):
        return None
    if stable(high):
        return high
    for _ in range(_HALVINGS):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return low


def _down(value: float) -> float:
    """Towards minus infinity, to the digits that are told."""
    if value == 0.0:
        return 0.0
    unit = 10.0 ** (math.floor(math.log10(abs(value))) - _DIGITS + 1)
    return float(f"{math.floor(value / unit * (1.0 + math.copysign(1e-9, value))) * unit:.{_DIGITS}g}")


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
    return AsItIsResult.taken_from(
        own,
        engine=MUJOCO,
        preset="as-shipped",
        dt_s=own.dt,
        stop=_stop(own),
        diverges_after=own.diverges,
        differs=None if beside is None else _differs(own, reduced, beside),
    )


def _stop(own: AsItIs) -> StopResult | None:
    if own.stop is None:
        return None
    stopped = math.isfinite(own.stop.time)
    return StopResult.taken_from(
        own.stop,
        speed=own.stop.v0,
        time_s=own.stop.time if stopped else None,
        exact_time_s=own.stop.exact_time,
        travel=own.stop.travel if stopped else None,
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
    more = {"version": found.version, "dt_s": found.dt, "creep": found.creep, "diverges_after": found.diverges}
    gone: dict[str, object] = {"break_away": own.friction, "switched_off": 0.0, "stop": None, "notes": []}
    shipped = "tuned" if preset == "tuned" else "as-shipped"
    return [AsItIsResult.taken_from(own, engine=PYBULLET, preset=shipped, **more, **gone)]
