"""Logs of one robot that were diagnosed each: their joints' friction compared."""

from collections.abc import Sequence
from pathlib import Path

from harness.app.diagnose.conditions import Conditions, in_order
from harness.app.shared.machine import this_machine
from harness.core.quantity import Quantity
from harness.diagnosis.rules import CHANCE
from harness.results.common import P
from harness.results.diagnosis import DiagnosisResult, RuleResult
from harness.results.fleet import FleetLog, FleetResult, FleetRow
from harness.results.robot import CurveResult
from harness.robot.fleet import Compared, Values, compared, over_speed

COEFFICIENTS = {"f_k": "Coulomb friction", "c": "viscous friction"}
"""Of a joint whose logs have no speeds in common."""


def fleet_of(
    answers: Sequence[DiagnosisResult], robot: Path, conditions: Conditions | None = None, command: str = ""
) -> FleetResult:
    """Compare; conditions : of some or all of the logs."""
    files = [answer.recording.file for answer in answers]
    given = in_order(conditions or {}, files)
    values, speeds = _values(answers)
    rows = [_row(one, files, speeds.get((one.joint, one.parameter))) for one in compared(values, given)]
    differing = [row.said for row in rows if row.differs or any(trend.differs for trend in row.trends)]
    none = f"In {len(files)} logs no joint's friction differs by more than its errors."
    return FleetResult(
        robot=str(robot.absolute()),
        logs=[FleetLog(file=file, conditions={name: given[name][i] for name in given}) for i, file in enumerate(files)],
        rows=rows,
        statements=differing or [none],
        rules=[RuleResult.taken_from(CHANCE)],
        command=command,
        machine=this_machine(),
    )


Speeds = dict[tuple[str, str], float]
"""By joint and parameter, where that is friction at a speed."""


def _values(answers: Sequence[DiagnosisResult]) -> tuple[list[Values], Speeds]:
    """Friction of every joint that a log says something of, at speeds that all logs with it cover."""
    every = [_joints(answer) for answer in answers]
    found: list[dict[str, dict[str, Quantity]]] = [{} for _ in answers]
    speeds: Speeds = {}
    for joint in dict.fromkeys(name for own in every for name in own):
        at, values = over_speed([own[joint][0] if joint in own else None for own in every])
        speeds |= {(joint, name): speed for name, speed in at.items()}
        for mine, own, told in zip(found, every, values, strict=True):
            if joint in own:
                mine[joint] = told or ({} if at else own[joint][1])
    return list(found), speeds


def _joints(answer: DiagnosisResult) -> dict[str, tuple[CurveResult | None, dict[str, Quantity]]]:
    """Of each joint its curve, and its coefficients."""
    robot = answer.robot
    if robot is None:
        return {}
    if robot.arm is not None:
        return {
            one.joint: (one.curve, {name: _quantity(getattr(one, name)) for name in COEFFICIENTS})
            for one in robot.arm.joints
        }
    own = answer.refined.parameters
    return {robot.joint: (answer.curve, {name: _quantity(own[name]) for name in COEFFICIENTS if name in own})}


def _quantity(p: P) -> Quantity:
    return Quantity(p.value, p.stderr, p.unit, why=p.why)


def _row(one: Compared, files: Sequence[str], speed: float | None) -> FleetRow:
    """speed : at which friction is compared, None of a coefficient."""
    place = "rad/s" if "m" in one.mean.unit else "m/s"
    what = f"{one.joint}: " + (COEFFICIENTS[one.parameter] if speed is None else f"friction at {speed:.2g} {place}")
    if one.differs:
        apart = f"{Path(files[one.apart]).name} ({one.values[one.apart]})"
        share = one.between / abs(one.mean.value) if one.mean.value else 0.0
        said = [f"{what} differs between logs beyond its errors, by {share:.1%}, most in {apart}"]
    else:
        said = [f"{what} is {one.mean} in all"]
    said += [trend.said for trend in one.trends if trend.differs]
    return FleetRow.taken_from(one, apart=files[one.apart], speed=speed, said=f"{'; '.join(said)}.")
