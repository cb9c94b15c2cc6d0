"""What somebody asks of a diagnosis, checked as one: options that contradict each other are refused."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, get_args

from harness.app.diagnose.robot_options import RobotOptions
from harness.core.budget import USUAL
from harness.core.checks import positive
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.request import AskedCovariate
from harness.engines import registry
from harness.engines.base import PRESETS, Preset, choice
from harness.io.options import ReadOptions
from harness.model.covariate import Acts
from harness.model.model import Model, Restoring

Zero = Literal["spring", "free"]
ZEROS: tuple[Zero, ...] = get_args(Zero)


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
    budget : s of a usual processor that trying laws may cost, None for the usual.

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

    def __post_init__(self) -> None:
        if self.mass is not None:
            positive("--mass", self.mass, "kg")
        if self.horizon is not None:
            positive("--horizon", self.horizon, "s")
        if self.budget is not None:
            positive("--budget", self.budget, "s")
        if self.dt is not None:
            positive("--dt", self.dt, "s")
            if self.preset == "as-shipped":
                accepted = "it is accepted with tuned: as shipped has its own"
                raise InputError("--dt", "given with --preset as-shipped", accepted)
        if self.zero == "spring" and self.restoring not in (None, Restoring.SPRING):
            found = f"spring with --restoring {self.restoring.value if self.restoring else ''}"
            raise InputError("--zero", found, "free is accepted there")
        if self.sim is not None and (self.preset == "as-shipped" or self.dt is not None):
            option = "--dt" if self.dt is not None else "--preset as-shipped"
            raise InputError(
                "--sim", f"given with {option}", "one of the two is accepted: a trace has its own settings"
            )
        if self.covariates and (self.sim is not None or self.model is not None):
            other = "--sim" if self.sim is not None else "--model"
            accepted = "one of the two is accepted: a simulation is not given covariates"
            raise InputError("--covariate", f"given with {other}", accepted)
        names = [one.name for one in self.covariates]
        if twice := [name for name in names if names.count(name) > 1]:
            raise InputError("--covariate", f"{twice[0]} given twice", "each column once is accepted")
        for name in self.engines:
            registry.check(name, "--engine")
        if self.robot is not None:
            self._check_robot()

    def _check_robot(self) -> None:
        """Refuse what a robot's model says itself, and what is not done with a log of joints."""
        for option, value in (("mass", self.mass), ("restoring", self.restoring), ("zero", self.zero)):
            if value is not None:
                raise InputError("--robot", f"given with --{option}", "the model of the robot says it; leave it out")
        for option, other in (
            ("model", self.model), ("sim", self.sim), ("validate", self.validate), ("trace", self.trace),
            ("covariate", self.covariates or None),
        ):  # fmt: skip
            if other is not None:
                raise InputError("--robot", f"given with --{option}", "one of the two is accepted")

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
        if restoring is not None:
            choice("--restoring", restoring, tuple(kind.value for kind in Restoring))
        if zero is not None:
            choice("--zero", zero, ZEROS)
        if preset is not None:
            choice("--preset", preset, PRESETS)
        named = registry.usual() if engines is None else tuple(dict.fromkeys(engines))
        held = None if restoring is None else Restoring(restoring)
        acting = tuple(map(_covariate, covariates))
        reading = replace(reading, covariates=tuple(one.name for one in acting))
        return cls(
            reading,
            restoring=held,
            zero=zero,  # type: ignore[arg-type]
            engines=named,
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
        """Every option in force, as results hold it."""
        r = self.reading
        return {
            "columns": r.columns,
            "skip_rows": r.skip_rows,
            "rate_hz": r.rate,
            "from_s": r.start,
            "to_s": r.stop,
            "drop_nan": r.drop_nan,
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
            **({"covariates": [_written(one) for one in self.covariates]} if self.covariates else {}),
        }


def _covariate(text: str) -> AskedCovariate:
    """NAME or NAME:KIND."""
    name, colon, kind = text.rpartition(":")
    if not colon:
        name = kind
    if not name.strip():
        raise InputError("--covariate", f"'{text}'", "NAME or NAME:force, :friction or :damping is accepted")
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
