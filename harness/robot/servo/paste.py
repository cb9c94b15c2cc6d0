"""What a servo's log says, in the words of others: a joint and its position actuator for MuJoCo, BAM's parameters."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from xml.sax.saxutils import quoteattr

from harness.robot.paste import JointPaste
from harness.robot.servo.fit import ServoFit
from harness.robot.servo.kernel import GAUSSIAN
from harness.robot.servo.presets import Preset

_BAM = {"sts3215": "sts3215", "sts3215-12v": "sts321512v", "xl330": "xl330"}
"""Names of BAM's actuators."""
_UNSAYABLE = {
    "concave": "torque that grows less than the duty",
    "most": "a limit of the torque below that of the duty",
    "play": "play",
    "dead": "a dead band",
    "ramp": "a limit of the goal's speed",
    "kd": "a derivative gain",
}


@dataclass(frozen=True, slots=True)
class ServoPaste:
    """A joint and its position actuator. kp : N m/rad. most : N m. delay : s, of goals. joint : friction, damping with
    the motor's, rotor.
    """

    joint: JointPaste
    kp: float
    most: float
    delay: float

    @property
    def mjcf(self) -> str:
        """The joint's element, and the actuator's."""
        name = quoteattr(self.joint.joint)
        limit = "" if math.isinf(self.most) else f' forcerange="{-self.most:.6g} {self.most:.6g}"'
        return f'{self.joint.mjcf}\n<position joint={name} kp="{self.kp:.6g}" kv="0"{limit}/>'

    @property
    def urdf(self) -> str:
        """<dynamics>, and the call of every step for PyBullet."""
        clip = f"{self.kp:.6g} * (goal - p.getJointState(body, joint)[0])"
        if not math.isinf(self.most):
            clip = f"max(-{self.most:.6g}, min({self.most:.6g}, {clip}))"
        return f"{self.joint.urdf}\np.setJointMotorControl2(body, joint, p.TORQUE_CONTROL, force={clip})  # every step"


def pasted(found: ServoFit, joint: str, volts: float, kp: float, dt: float) -> ServoPaste:
    """The words that MuJoCo and PyBullet have for a fit of torque, damping, rotor and dry friction alone."""
    values = {**found.logs.known, **found.values}
    stiff = values["stall"] * volts * values["gain"] * kp
    most = values["stall"] * volts * values.get("limit", math.inf)
    damping = max(values.get("brake", 0.0) + values["c"], 0.0)
    own = JointPaste(joint, values["f_k"], damping, max(values["armature"], 0.0), dt)
    return ServoPaste(own, stiff, min(most, values.get("most", math.inf)), values["delay"])


def bam(found: ServoFit, servo: Preset | None, volts: float) -> tuple[dict[str, float | str], list[str]]:
    """A file of BAM's parameters as a mapping, and what it cannot say. volts : of the supply."""
    values: Mapping[str, float] = {**found.logs.known, **found.values}
    stall, c = values["stall"], values["c"]
    k_t = servo.k_t if servo is not None and "brake" in found.logs.known else values["brake"] / stall
    viscous = max(c + values["brake"] - stall * k_t, 0.0)
    said: dict[str, float | str] = {"kt": k_t, "R": k_t / stall, "armature": values["armature"]}
    said |= {"q_offset": values.get("zero", 0.0), "command_delay": values["delay"], "friction_base": values["f_k"]}
    said |= {"friction_viscous": viscous}
    rest = "f_s" in values or "load_rest" in values
    sides = "load_motor" in values or "load_rest" in values
    if rest:
        alpha = values.get("exponent", GAUSSIAN)
        said |= {"friction_stribeck": values.get("f_s", 0.0), "dtheta_stribeck": values["v_s"], "alpha": alpha}
    if sides:
        said["load_friction_motor"] = values.get("load_motor", values.get("load", 0.0))
        said["load_friction_external"] = values.get("load_external", values.get("load", 0.0))
        said |= {"load_friction_motor_stribeck": values.get("load_rest", 0.0), "load_friction_external_stribeck": 0.0}
    elif "load" in values:
        said["load_friction_base"] = values["load"]
        said |= {"load_friction_stribeck": 0.0} if rest else {}
    loaded = "load" in values or sides
    said["model"] = "m5" if sides else ("m4" if loaded else "m2") if rest else ("m3" if loaded else "m1")
    said["actuator"] = _BAM.get(servo.name if servo else "", "")
    lost = [f"BAM has no word for {text}" for name, text in _UNSAYABLE.items() if name in values]
    if "gain" in found.logs.known and servo is not None:
        lost.append(f"these numbers are for error_gain = {values['gain']:.6g} and vin = {volts:.4g}")
    return said, lost
