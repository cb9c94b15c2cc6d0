"""Logs of one robot that were diagnosed each: their joints' friction compared."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path

from harness.app.shared.machine import this_machine
from harness.core.bounded import MEBIBYTE, read_bytes
from harness.core.errors import InputError
from harness.core.quantity import Quantity
from harness.results.common import P
from harness.results.diagnosis import DiagnosisResult, RuleResult
from harness.results.fleet import FleetLog, FleetResult, FleetRow, FleetTrend
from harness.robot.fleet import CHANCE, Compared, Trend, Values, compared

PARAMETERS = {"f_k": "Coulomb friction", "c": "viscous friction"}
Conditions = Mapping[str, Mapping[str, float]]
"""By the log's file name, numbers by name."""
_FILE = "file"


def fleet_of(
    answers: Sequence[DiagnosisResult], robot: Path, conditions: Conditions | None = None, command: str = ""
) -> FleetResult:
    """Compare; conditions : of some or all of the logs."""
    files = [answer.recording.file for answer in answers]
    known = conditions or {}
    names = list(dict.fromkeys(name for one in known.values() for name in one))
    given = {name: [known.get(Path(file).name, {}).get(name) for file in files] for name in names}
    rows = [_row(one, files) for one in compared([_values(answer) for answer in answers], given)]
    differing = [row.said for row in rows if row.differs or any(trend.differs for trend in row.trends)]
    none = f"In {len(files)} logs no joint's friction differs by more than its errors."
    return FleetResult(
        robot=str(robot.absolute()),
        logs=[FleetLog(file=file, conditions={name: given[name][i] for name in names}) for i, file in enumerate(files)],
        rows=rows,
        statements=differing or [none],
        rules=[RuleResult(name=CHANCE.name, value=CHANCE.value, unit=CHANCE.unit, origin=CHANCE.origin)],
        command=command,
        machine=this_machine(),
    )


def _values(answer: DiagnosisResult) -> Values:
    """Friction of every joint that a log says something of."""
    robot = answer.robot
    if robot is None:
        return {}
    if robot.arm is not None:
        return {one.joint: {name: _quantity(getattr(one, name)) for name in PARAMETERS} for one in robot.arm.joints}
    own = answer.refined.parameters
    return {robot.joint: {name: _quantity(own[name]) for name in PARAMETERS if name in own}}


def _quantity(p: P) -> Quantity:
    return Quantity(p.value, p.stderr, p.unit, why=p.why)


def _row(one: Compared, files: Sequence[str]) -> FleetRow:
    names = [Path(file).name for file in files]
    return FleetRow(
        joint=one.joint,
        parameter=one.parameter,
        values=[None if value is None else P.of(value) for value in one.values],
        mean=P.of(one.mean),
        chi2=one.chi2,
        freedom=one.freedom,
        chance=one.chance,
        apart=files[one.apart],
        differs=one.differs,
        trends=[FleetTrend(name=t.name, slope=P.of(t.slope), differs=t.differs) for t in one.trends],
        said=_said(one, names),
    )


def _said(one: Compared, names: Sequence[str]) -> str:
    what = f"{one.joint}: {PARAMETERS[one.parameter]}"
    if one.differs:
        said = [f"{what} differs between logs beyond its errors, most in {names[one.apart]} ({one.values[one.apart]})"]
    else:
        said = [f"{what} is {one.mean} in all"]
    said += [_of_trend(trend) for trend in one.trends if trend.differs]
    return f"{'; '.join(said)}."


def _of_trend(trend: Trend) -> str:
    return f"it changes with {trend.name}: {trend.slope}"


def read_conditions(path: Path) -> dict[str, dict[str, float]]:
    """Conditions of logs from a CSV with a column ``file`` and numbers (temperature, day, hours run).

    Raises InputError naming the file, and the line or column that is wrong.
    """
    try:
        text = read_bytes(path, MEBIBYTE).decode()
    except UnicodeDecodeError:
        raise InputError(str(path), "no text", "a CSV with a column file is accepted") from None
    rows = csv.DictReader(text.splitlines())
    if _FILE not in (rows.fieldnames or ()):
        found = f"columns {', '.join(rows.fieldnames or ()) or 'none'}"
        raise InputError(str(path), found, "a CSV with a column file and others of numbers is accepted")
    found_of: dict[str, dict[str, float]] = {}
    for row in rows:
        name = Path(row.pop(_FILE) or "").name
        found_of[name] = {}
        for column, value in row.items():
            if column is None or value in (None, ""):
                continue
            try:
                found_of[name][column] = float(str(value))
            except ValueError:
                where = f"{path}, line {rows.line_num}, column {column}"
                raise InputError(where, repr(value), "a number, or nothing, is accepted") from None
    return found_of
