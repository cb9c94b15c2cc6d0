"""To and from mujoco.sysid (extra proof): TimeSeries as a log, a log as TimeSeries, friction as a ParameterDict.

Who fits with mujoco.sysid gets the friction curve and checks of ``harness.diagnose_joint`` too, and what it names as
parameters with bounds.
"""

from collections.abc import Mapping
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.robot import JointLog
from harness.results.common import P
from harness.results.diagnosis import DiagnosisResult

_FIELDS, _WORDS = ("position", "velocity", "effort"), ("frictionloss", "damping")
_LEAST = 0.05
"""Share of a value that its bounds lie off at least."""


def log_of(model: Any, sensor: Any, control: Any = None, file: str = "sysid") -> JointLog:
    """A log of the joints in what mujoco.sysid is given: TimeSeries of what was measured and of the controls.

    Positions and velocities are those of states (NAME_qpos, NAME_qvel) or of sensors (jointpos, jointvel); efforts
    those of a sensor (jointactuatorfrc), else the controls of motors times their gear. Raises InputError where there is
    no position, or an actuator's torque is not its control.
    """
    found: dict[str, dict[str, FloatArray]] = {kind: {} for kind in _FIELDS}
    for name, (kind, at) in _mapping(sensor).items():
        if (said := _of_sensor(model, name, kind.name)) is not None:
            found[said[0]][said[1]] = np.asarray(sensor.data, dtype=np.float64)[:, at[0]]
    t = np.asarray(sensor.times, dtype=np.float64)
    for name, (_, at) in _mapping(control).items() if control is not None else ():
        number = model.actuator(name.removesuffix("_ctrl")).id
        if (joint := _joint(model, number)) not in found["effort"]:
            # a control is held until the next one
            held = np.clip(np.searchsorted(control.times, t, side="right") - 1, 0, None)
            found["effort"][joint] = _gear(model, number) * np.asarray(control.data, dtype=np.float64)[held, at[0]]
    return JointLog(t - t[0], found["position"], found["velocity"], found["effort"], file)


def series_of(log: JointLog, model: Any) -> tuple[Any, Any]:
    """Control and sensor, each a TimeSeries, of a log: its efforts by the motors of a model, its positions (and
    velocities, where every joint has one) as states. Raises InputError where a joint with effort has no motor."""
    made = import_module("mujoco.sysid")
    controls, names = [], []
    for joint, effort in log.effort.items():
        number = next((i for i in range(model.nu) if _joint(model, i) == joint), None)
        if number is None:
            raise InputError(f"{log.file}: {joint}", "no motor in the model", f'<motor joint="{joint}"/>')
        controls.append(effort / _gear(model, number))
        names.append(model.actuator(number).name)
    states = {made.SignalType.MjStateQPos: log.position, made.SignalType.MjStateQVel: log.velocity}
    seen = {(joint, kind): y for kind, of in states.items() if len(of) == len(log.position) for joint, y in of.items()}
    control = made.TimeSeries.from_control_names(log.t, np.stack(controls, axis=1), model, names)
    return control, made.TimeSeries.from_names(log.t, np.stack([*seen.values()], axis=1), model, [*seen])


def write_log(log: JointLog, path: Path) -> Path:
    """A log as CSV, as ``harness.diagnose_joint`` and every command read it."""
    columns = {"t": log.t} | {f"{joint}.{kind}": y for kind in _FIELDS for joint, y in getattr(log, kind).items()}
    np.savetxt(path, np.column_stack([*columns.values()]), "%.12g", ",", header=",".join(columns), comments="")
    return path


def parameters_of(result: DiagnosisResult, errors: float = 5.0) -> Any:
    """A ParameterDict with frictionloss and damping of every joint of a diagnosis, called JOINT_frictionloss and so on.

    Values are those of the friction curve's line where there is one, bounds so many standard errors off, not below 0;
    each writes itself into a spec. Raises InputError for a result of no robot.
    """
    made = import_module("mujoco.sysid")
    found = made.ParameterDict()
    for joint, numbers in _friction(result).items():
        for word, number in zip(_WORDS, numbers, strict=True):
            value = max(number.value or 0.0, 0.0)
            reach = max(errors * (number.stderr or 0.0), _LEAST * value, 1e-6)
            bounds = max(value - reach, 0.0), value + reach

            found.add(made.Parameter(f"{joint}_{word}", value, *bounds, modifier=partial(_write, joint, word)))
    return found


def _write(joint: str, word: str, spec: Any, parameter: Any) -> None:
    size = float(parameter.value[0])  # damping is a polynomial of the speed
    setattr(spec.joint(joint), word, [size, 0.0, 0.0] if word == "damping" else size)


def friction_of(parameters: Any, spec: Any) -> dict[str, dict[str, float]]:
    """Dry friction, damping and armature of every joint of a spec with a ParameterDict in it, however it calls them."""
    spec = spec.copy()
    for parameter in parameters.values():
        parameter.apply_modifier(spec)
    model = spec.compile()
    words = ("frictionloss", "damping", "armature")
    places = {model.joint(i).name: model.jnt_dofadr[i] for i in range(model.njnt)}
    return {name: {word: float(getattr(model, f"dof_{word}")[at]) for word in words} for name, at in places.items()}


def _mapping(series: Any) -> Mapping[str, Any]:
    if series.signal_mapping is None:
        accepted = "one made by TimeSeries.from_names or from_control_names"
        raise InputError("a TimeSeries", "no names of its signals", accepted)
    return dict(series.signal_mapping)


def _of_sensor(model: Any, name: str, kind: str) -> tuple[str, str] | None:
    """What a signal is, and whose; None for what says nothing of a joint."""
    states = {"MjStateQPos": ("position", "_qpos"), "MjStateQVel": ("velocity", "_qvel")}
    if kind in states:
        return states[kind][0], name.removesuffix(states[kind][1])
    if kind != "MjSensor":
        return None
    sensor, number = model.sensor(name), import_module("mujoco").mjtSensor
    of, whose = int(sensor.type[0]), int(sensor.objid[0])
    words = (("POS", "position"), ("VEL", "velocity"), ("ACTFRC", "effort"))
    kinds = {int(getattr(number, f"mjSENS_JOINT{end}")): word for end, word in words}
    return (kinds[of], model.joint(whose).name) if of in kinds else None


def _joint(model: Any, number: int) -> str:
    """Of an actuator; "" of one on anything else."""
    own = model.actuator(number)
    return model.joint(own.trnid[0]).name if own.trntype[0] == import_module("mujoco").mjtTrn.mjTRN_JOINT else ""


def _gear(model: Any, number: int) -> float:
    """Torque of an actuator for a control of 1."""
    own = model.actuator(number)
    if own.gaintype[0] or own.biastype[0]:  # fixed and none are 0
        accepted = "a motor of a joint, or a sensor <jointactuatorfrc>"
        raise InputError(f"actuator {own.name}", "its torque is not its control", accepted)
    return float(own.gear[0] * own.gainprm[0])


def _friction(result: DiagnosisResult) -> Mapping[str, tuple[P, P]]:
    """Coulomb and viscous friction of the joints of a diagnosis."""
    if result.robot is None:
        raise InputError("result", "no robot's joint", "one of harness.diagnose_joint")
    if result.robot.arm is None:
        known = result.refined.parameters
        return {result.robot.joint: (known["f_k"], known["c"])}
    lines = {one.joint: one.curve.line if one.curve else [one.f_k, one.c] for one in result.robot.arm.joints}
    return {joint: (line[0], line[1]) for joint, line in lines.items()}
