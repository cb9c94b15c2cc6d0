"""What somebody asks of a diagnosis, checked as one: options that contradict each other are refused."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, Literal, get_args

from harness.app.diagnose.conditions import Conditions
from harness.core.budget import USUAL
from harness.core.checks import finite, positive
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.request import AskedCovariate
from harness.engines import registry
from harness.engines.base import PRESETS, Preset, choice
from harness.io.options import ReadOptions
from harness.model.covariate import Acts
from harness.model.model import Model, Restoring

Gain = float | tuple[float, ...] | Mapping[str, float]
"""N m per A (N per A): of all joints, one each in the model's order, or by joint."""
Sensor = Literal["link", "motor"]
_MOST_GRAVITY = 100.0
"""m/s^2: more is a mistyped number."""


@dataclass(frozen=True, slots=True)
class RobotOptions:
    """A robot's model and what is known of its log.

    file : MJCF or URDF. joint : of both, or "all"; None for the only one that moves, or all. gain : of a log in
    amperes, N m per A (N per A) at the joint, for all, one each in the model's order, or by joint. gravity : m/s^2 in
    the frame of the base, None for the model's own. payload : at the last body, kg. sensor : the side of the gearbox on
    which the torque is measured. names, flip, offset, angle_unit, join, calibration, topic : as ``read_joint_log`` has
    them.

    Raises InputError for a number that is none, or not above 0, and for a side that does not exist.
    """

    file: Path
    joint: str | None = None
    gain: Gain | None = None
    gravity: tuple[float, float, float] | None = None
    payload: float | None = None
    sensor: Sensor | None = None
    names: Mapping[str, str] = field(default_factory=dict)
    flip: tuple[str, ...] = ()
    offset: Mapping[str, float] = field(default_factory=dict)
    angle_unit: str | None = None
    join: tuple[Path, ...] = ()
    calibration: Path | None = None
    topic: str | None = None

    def __post_init__(self) -> None:
        gains = () if self.gain is None else self.gain.values() if isinstance(self.gain, Mapping) else self.gain
        for value in gains if not isinstance(gains, float | int) else (gains,):
            if finite("--gain", value) == 0.0:
                raise InputError("--gain", "0", "a number other than 0, N m per A")
        for value in self.offset.values():
            finite("--offset", value)
        if self.gravity is not None:
            for value in self.gravity:
                if abs(finite("--gravity", value)) > _MOST_GRAVITY:
                    raise InputError("--gravity", f"{value:g} m/s^2", f"at most {_MOST_GRAVITY:g} m/s^2")
        if self.payload is not None:
            positive("--payload", self.payload, "kg")
        if self.sensor is not None:
            choice("--sensor", self.sensor, get_args(Sensor))

    @classmethod
    def chosen(cls, robot: Path | None, **given: Any) -> "RobotOptions | None":
        """As somebody chose, None where no robot is given; text is read as the command takes it.

        Raises InputError for text that cannot be read, and for what is given without a robot.
        """
        told = {
            name: _READ[name](value) if isinstance(value, str) and name in _READ else value
            for name, value in given.items()
            if value not in (None, {}, ())
        }
        if robot is not None:
            return cls(robot, **told)
        for name in told:
            option = f"--{name.replace('_', '-')}"
            raise InputError(option, "given without --robot", "it goes with --robot FILE")
        return None

    def settings(self) -> dict[str, Any]:
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
            "join": [str(path.absolute()) for path in self.join],
            "calibration": None if self.calibration is None else str(self.calibration.absolute()),
            "topic": self.topic,
        }


def _gain(text: str) -> Gain:
    if "=" in text:
        return _numbers("--gain", text)
    found = tuple(_number("--gain", one) for one in text.split(","))
    return found[0] if len(found) == 1 else found


def _named(option: str, text: str) -> dict[str, str]:
    found = {}
    for part in text.split(","):
        name, equals, value = (piece.strip() for piece in part.partition("="))
        if not (name and equals and value):
            raise InputError(option, repr(part), "NAME=VALUE,...")
        found[name] = value
    return found


def _numbers(option: str, text: str) -> dict[str, float]:
    return {name: _number(option, value) for name, value in _named(option, text).items()}


def _number(option: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(option, repr(text), "a number, or NAME=NUMBER for each joint") from None


_READ: Mapping[str, Callable[[str], Any]] = {
    "gain": _gain,
    "names": partial(_named, "--names"),
    "flip": lambda text: tuple(name.strip() for name in text.split(",")),
    "offset": partial(_numbers, "--offset"),
}
"""How text becomes an option."""


@dataclass(frozen=True, slots=True)
class ServoOptions:
    """What somebody says of a servo whose goals and positions are logged.

    name : of a preset, None where nobody says it. gains : its own gain in force, one, or one a log; none for the
    preset's. angle_unit : of goals and positions that say none, where no robot's options have it.
    """

    name: str | None = None
    gains: tuple[float, ...] = ()
    angle_unit: str | None = None

    def __post_init__(self) -> None:
        for gain in self.gains:
            positive("--servo, after the colon", gain, "")

    @classmethod
    def chosen(cls, text: str | None, angle_unit: str | None = None) -> "ServoOptions | None":
        """NAME, NAME:GAIN or NAME:GAIN,GAIN,...; None where nothing is given. Raises InputError."""
        if text is None and angle_unit is None:
            return None
        name, _, gains = (text or "").partition(":")
        numbers = tuple(_number("--servo", one) for one in gains.split(",") if one.strip())
        return cls(name.strip() or None, numbers, angle_unit)

    def settings(self) -> dict[str, Any]:
        unit = {} if self.angle_unit is None else {"angle_unit": self.angle_unit}
        return {"servo": self.name, "gains": list(self.gains)} | unit


Zero = Literal["spring", "free"]


@dataclass(frozen=True, slots=True)
class DiagnoseOptions:
    """How to diagnose.

    reading : how to read the recording. trace : which trace of a .rrd. model : the simulation as the user has it, a
    model.json or a Model. sim : a trace of the user's own simulation. sim_reading : how to read it. validate : another
    recording. mass : kg, None when unknown. horizon : of a driven recording's windows, s. restoring : what pulls back.
    zero : whether x is measured from the unstretched spring. Both None: chosen at the base fit, and said. engines : in
    which the fit is shown, the first is what the mismatch is attributed to; there may be none. preset, dt : of the
    engines; dt in s, None for one that suits the recording (as shipped: the engine's own). covariates : columns of the
    recording that act on the slider. robot : whose joint's log the
    recording is. guarded : it is a robot's joint, whose fitted force does not count beside reversals.
    budget : s of a usual processor that trying laws may cost, None for the usual. servo : whose goals and positions the
    recording is. conditions : under which each of several recordings together was made.

    Raises InputError for a value that does not exist and for options that contradict each other.
    """

    reading: ReadOptions = field(default_factory=ReadOptions)
    trace: str | None = None
    model: Path | Model | None = None
    sim: Path | Recording | None = None
    sim_reading: ReadOptions = field(default_factory=ReadOptions)
    mass: float | None = None
    horizon: float | None = None
    validate: Path | Recording | None = None
    restoring: Restoring | None = None
    zero: Zero | None = None
    engines: tuple[str, ...] = field(default_factory=registry.usual)
    preset: Preset = "tuned"
    dt: float | None = None
    covariates: tuple[AskedCovariate, ...] = ()
    robot: RobotOptions | None = None
    guarded: bool = False
    budget: float | None = None
    servo: ServoOptions | None = None
    conditions: Conditions = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name, unit in (("mass", "kg"), ("horizon", "s"), ("budget", "s"), ("dt", "s")):
            if (value := getattr(self, name)) is not None:
                positive(f"--{name}", value, unit)
        if self.dt is not None and self.preset == "as-shipped":
            accepted = "it goes with tuned: as shipped has its own"
            raise InputError("--dt", "given with --preset as-shipped", accepted)
        if self.zero == "spring" and self.restoring not in (None, Restoring.SPRING):
            found = f"spring with --restoring {self.restoring.value if self.restoring else ''}"
            raise InputError("--zero", found, "free")
        one = "one of the two"
        if self.sim is not None and (self.preset == "as-shipped" or self.dt is not None):
            option = "--dt" if self.dt is not None else "--preset as-shipped"
            raise InputError("--sim", f"given with {option}", f"{one}: a trace has its own settings")
        if self.covariates and (self.sim is not None or self.model is not None):
            other = "--sim" if self.sim is not None else "--model"
            raise InputError("--covariate", f"given with {other}", f"{one}: a simulation is not given covariates")
        names = [acting.name for acting in self.covariates]
        if twice := [name for name in names if names.count(name) > 1]:
            raise InputError("--covariate", f"{twice[0]} given twice", "each column once")
        for name in self.engines:
            registry.check(name, "--engine")
        if self.robot is not None:
            self._check_robot()
        if self.servo is not None:
            for option in ("model", "sim", "validate", "trace", "covariates", "mass", "restoring", "zero"):
                if getattr(self, option) not in (None, ()):
                    found = f"given with --{option.removesuffix('s')}"
                    raise InputError("--servo", found, "one of the two")

    def _check_robot(self) -> None:
        """Refuse what a robot's model says itself, and what is not done with a log of joints."""
        for option in ("mass", "restoring", "zero"):
            if getattr(self, option) is not None:
                raise InputError("--robot", f"given with --{option}", "what the model of the robot says; leave it out")
        for option in ("model", "sim", "validate", "trace", "covariates"):
            if getattr(self, option) not in (None, ()):
                said = f"given with --{option.removesuffix('s')}"
                raise InputError("--robot", said, "one of the two")

    @classmethod
    def chosen(
        cls,
        reading: ReadOptions,
        restoring: str | None = None,
        zero: str | None = None,
        engines: Sequence[str] | None = None,
        preset: str | None = None,
        covariates: Sequence[str] = (),
        **rest: Any,
    ) -> "DiagnoseOptions":
        """As somebody chose, by name; engines None: MuJoCo and PyBullet; covariates: NAME or NAME:KIND, read too.

        Raises InputError listing what there is.
        """
        for option, given, known in (
            ("--restoring", restoring, tuple(kind.value for kind in Restoring)),
            ("--zero", zero, get_args(Zero)),
            ("--preset", preset, PRESETS),
        ):
            if given is not None:
                choice(option, given, known)
        acting = tuple(map(_covariate, covariates))
        return cls(
            replace(reading, covariates=tuple(one.name for one in acting), angle=restoring == Restoring.PENDULUM.value),
            restoring=None if restoring is None else Restoring(restoring),
            zero=zero,  # type: ignore[arg-type]
            engines=registry.usual() if engines is None else tuple(dict.fromkeys(engines)),
            preset=preset or "tuned",  # type: ignore[arg-type]
            covariates=acting,
            **rest,
        )

    @property
    def seconds(self) -> float:
        """That trying laws may cost."""
        return USUAL if self.budget is None else self.budget

    @property
    def zero_free(self) -> bool | None:
        """Whether x is measured from an unknown zero; None where nobody says."""
        if self.zero is None:
            return True if self.restoring is Restoring.PENDULUM else None
        return self.zero == "free"

    def settings(self) -> dict[str, Any]:
        r = self.reading
        return {
            "columns": r.columns,
            "skip_rows": r.skip_rows,
            "rate_hz": r.rate,
            "from_s": r.start,
            "to_s": r.stop,
            "drop_nan": r.drop_nan,
            "run": r.run,
            "trace": self.trace,
            "model": _said(self.model),
            "sim": _said(self.sim),
            "sim_columns": self.sim_reading.columns,
            "sim_skip_rows": self.sim_reading.skip_rows,
            "sim_rate_hz": self.sim_reading.rate,
            "mass_kg": self.mass,
            "horizon_s": self.horizon,
            "validate": _said(self.validate),
            "restoring": None if self.restoring is None else self.restoring.value,
            "zero": self.zero,
            "engines": list(self.engines),
            "preset": self.preset,
            "dt_s": self.dt,
            **({} if self.budget is None else {"budget_s": self.budget}),
            **({} if self.robot is None else {"robot": self.robot.settings()}),
            **({} if self.servo is None else {"servo": self.servo.settings()}),
            **({"conditions": {file: dict(row) for file, row in self.conditions.items()}} if self.conditions else {}),
            **({"covariates": [_written(one) for one in self.covariates]} if self.covariates else {}),
        }


def _covariate(text: str) -> AskedCovariate:
    """NAME or NAME:KIND."""
    name, colon, kind = text.rpartition(":")
    if not colon:
        name = kind
    if not name.strip():
        raise InputError("--covariate", f"'{text}'", "NAME or NAME:force, :friction or :damping")
    if not colon:
        return AskedCovariate(name.strip())
    choice("--covariate, after the colon", kind, tuple(acts.value for acts in Acts))
    return AskedCovariate(name.strip(), Acts(kind))


def _written(one: AskedCovariate) -> str:
    return one.name if one.acts is None else f"{one.name}:{one.acts.value}"


def _said(given: Path | Recording | Model | None) -> str | None:
    """An absolute path, the name of a recording, or that it was no file."""
    match given:
        case Path():
            return str(given.absolute())
        case Recording(file=name):
            return name
        case Model():
            return "a Model"
    return None
