"""What somebody asks of a robot's joint, checked as one."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

from harness.core.checks import finite, positive
from harness.core.errors import InputError
from harness.engines.base import choice

Sensor = Literal["link", "motor"]
SENSORS: tuple[Sensor, ...] = get_args(Sensor)
_MOST_GRAVITY = 100.0
"""m/s^2: more is a mistyped number."""


@dataclass(frozen=True, slots=True)
class RobotOptions:
    """A robot's model and what is known of its log.

    file : MJCF or URDF. joint : of both, None for the only one that moves. gain : of a log in amperes, N m per A (N per
    A) at the joint. gravity : m/s^2 in the frame of the base, None for the model's own. payload : at the last body, kg.
    sensor : the side of the gearbox on which the torque is measured. any_joint : where several move and none is named,
    the first of them is what a result is of.

    Raises InputError for a number that is none, or not above 0, and for a side that does not exist.
    """

    file: Path
    joint: str | None = None
    gain: float | None = None
    gravity: tuple[float, float, float] | None = None
    payload: float | None = None
    sensor: Sensor | None = None
    any_joint: bool = False

    def __post_init__(self) -> None:
        if self.gain is not None and finite("--gain", self.gain) == 0.0:
            raise InputError("--gain", "0", "a number other than 0, N m per A, is accepted")
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
            if value is not None:
                raise InputError(f"--{name}", "given without --robot", "it is accepted with --robot FILE")
        return None

    def settings(self) -> dict[str, Any]:
        """Every option in force, as results hold it."""
        return {
            "robot": str(self.file.absolute()),
            "joint": self.joint,
            "gain_nm_per_a": self.gain,
            "gravity_m_s2": None if self.gravity is None else list(self.gravity),
            "payload_kg": self.payload,
            "sensor": self.sensor,
        }
