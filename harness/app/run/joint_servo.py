"""What a time step does to the servo of a robot's joint, by the laws of docs/fidelity.md."""

from collections.abc import Callable

from harness.fidelity import laws
from harness.results.joint import ServoResult, ServoScore
from harness.robot.arm import Arm
from harness.robot.reduction import Reduced
from harness.robot.servo import servo_of, words

_SUBSTEPS = 4
"""Of an engine that divides a step, as Rapier and PhysX's TGS ship."""


def servo_scores(arm: Arm, own: Reduced, h: float) -> ServoResult | None:
    """What the step does to the model's servo, by the laws of docs/fidelity.md."""
    servo = servo_of(arm, own.joint)
    if servo is None:
        return None
    m, k = own.moved, servo.stiffness
    joint, kv = float(arm.damping[arm.index(own.joint)]), servo.damping
    c = joint + kv
    integrator = words(arm, own.joint)["integrator"]
    by_mujoco: dict[str, Callable[[], float]] = {
        "Euler": lambda: laws.half_implicit(m, kv, joint, h),
        "RK4": lambda: c,
        "discrete": lambda: laws.implicit(m, c, k, h, 1),
    }
    acts: dict[str, Callable[[], float]] = {
        f"MuJoCo, {integrator}, as the model has it": by_mujoco.get(
            integrator, lambda: laws.half_implicit(m, 0.0, c, h)
        ),
        "a torque held over the step (PyBullet's TORQUE_CONTROL)": lambda: laws.held(m, c, k, h, 1),
        f"a torque held over {_SUBSTEPS} sub-steps (Rapier, PhysX TGS)": lambda: laws.held(m, c, k, h, _SUBSTEPS),
        "the engine's own implicit drive (DART, PhysX PGS)": lambda: laws.implicit(m, c, k, h, 1),
    }
    root = 2.0 * (k * m) ** 0.5
    scores = []
    for who, law in acts.items():
        try:
            acting = law()
        except ValueError:
            scores.append(ServoScore(who=who, false_damping=None, zeta=None))
            continue
        scores.append(ServoScore(who=who, false_damping=acting - c, zeta=acting / root))
    return ServoResult(stiffness=k, damping=c, zeta=c / root, step_s=h, scores=scores)
