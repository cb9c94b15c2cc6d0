"""What somebody asks of a robot's joint, checked as one."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, get_args

from harness.core.checks import finite, positive
from harness.core.errors import InputError
from harness.engines.base import choice

Gain = float | tuple[float, ...] | Mapping[str, float]
"""N m per A (N per A): of all joints, one each in the model's order, or by joint."""
Sensor = Literal["link", "motor"]
SENSORS: tuple[Sensor, ...] = get_args(Sensor)
_MOST_GRAVITY = 100.0
"""m/s^2: more is a mistyped number."""


@dataclass(frozen=True, slots=True)
class RobotOptions:
    """A robot's model and what is known of its log.

    file : MJCF or URDF. joint : of both, None for the only one that moves. gain : of a log in amperes, N m per A (N per
    A) at the joint, for all, one each in the model's order, or by joint. gravity : m/s^2 in the frame of the base, None
    for the model's own. payload : at the last body, kg. sensor : the side of the gearbox on which the torque is
    measured. any_joint : where several move and none is named, the first of them is what a result is of. names, flip,
    offset, angle_unit : as ``read_joint_log`` has them.

    Raises InputError for a number that is none, or not above 0, and for a side that does not exist.
    """

    file: Path
    joint: str | None = None
    gain: Gain | None = None
    gravity: tuple[float, float, float] | None = None
    payload: float | None = None
    sensor: Sensor | None = None
    any_joint: bool = False
    names: Mapping[str, str] = field(default_factory=dict)
    flip: tuple[str, ...] = ()
    offset: Mapping[str, float] = field(default_factory=dict)
    angle_unit: str | None = None

    def __post_init__(self) -> None:
        gains = () if self.gain is None else self.gain.values() if isinstance(self.gain, Mapping) else self.gain
        for value in gains if not isinstance(gains, float | int) else (gains,):
            if finite("--gain", value) == 0.0:
                raise InputError("--gain", "0", "a number other than 0, N m per A, is accepted")
        for value in self.offset.values():
            finite("--offset", value)
        if self.gravity is not None:
            for value in self.gravity:
                if abs(finite("--gravity", value)) > _MOST_GRAVITY:
                    raise InputError("--gravity", f"{value:g} m/s^2", f"at most {_MOST_GRAVITY:g} m/s^2 is accepted")
        if self.payload is not None:
            positive("--payload", self.payload, "kg")
        if self.sensor is not None:
            choice("--sensor", self.sensor, SENSORS)

    @classmethod
    def chosen(cls, robot: Path | None, **given: Any) -> "RobotOptions | None":
        """As somebody chose, None where no robot is given. Raises InputError for what is given without one."""
        if robot is not None:
            return cls(robot, **given)
        for name, value in given.items():
            if value not in (None, {}, ()):
                raise InputError(
                    f"--{name.replace('_', '-')}", "given without --robot", "it is accepted with --robot FILE"
                )
        return None

    @classmethod
    def written(
        cls,
        robot: tuple[Path, str | None, tuple[float, float, float] | None] | None,
        gain: str | None,
        names: str | None,
        flip: str | None,
        offset: str | None,
        **plain: Any,
    ) -> "RobotOptions | None":
        """As the command has them. robot : its file, joint and gravity; the rest : text. Raises InputError."""
        file, joint, gravity = robot or (None, None, None)
        return cls.chosen(
            file,
            joint=joint,
            gravity=gravity,
            gain=numbers("--gain", gain),
            names=names_by_name("--names", names),
            flip=tuple(name.strip() for name in flip.split(",")) if flip else (),
            offset={name: _number("--offset", value) for name, value in names_by_name("--offset", offset).items()},
            **plain,
        )

    def settings(self) -> dict[str, Any]:
        """Every option in force, as results hold it."""
        return {
            "robot": str(self.file.absolute()),
            "joint": self.joint,
            "gain_nm_per_a": dict(self.gain) if isinstance(self.gain, Mapping) else self.gain,
            "gravity_m_s2": None if self.gravity is None else list(self.gravity),
            "payload_kg": self.payload,
            "sensor": self.sensor,
            "names": dict(self.names),
            "flip": list(self.flip),
            "offset": dict(self.offset),
            "angle_unit": self.angle_unit,
        }


def numbers(option: str, text: str | None) -> Gain | None:
    """What --gain takes: a number, several, or NAME=NUMBER,... Raises InputError for anything else."""
    if text is None:
        return None
    if "=" in text:
        return {name: _number(option, value) for name, value in names_by_name(option, text).items()}
    found = tuple(_number(option, one) for one in text.split(","))
    return found[0] if len(found) == 1 else found


def names_by_name(option: str, text: str | None) -> dict[str, str]:
    """NAME=VALUE,... Raises InputError for anything else."""
    found = {}
    for part in (text or "").split(",") if text else ():
        name, equals, value = (piece.strip() for piece in part.partition("="))
        if not (name and equals and value):
            raise InputError(option, repr(part), "NAME=VALUE,... is accepted")
        found[name] = value
    return found


def _number(option: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(option, repr(text), "a number, or NAME=NUMBER,..., is accepted") from None
