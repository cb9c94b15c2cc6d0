"""What somebody asks of a diagnosis, checked as one: options that contradict each other are refused."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, get_args

from harness.core.checks import positive
from harness.core.errors import InputError
from harness.engines import registry
from harness.engines.base import PRESETS, Preset, choice
from harness.io.recording import ReadOptions
from harness.model.model import Restoring

Zero = Literal["spring", "free"]
ZEROS: tuple[Zero, ...] = get_args(Zero)
ENGINES = ("mujoco", "pybullet")


@dataclass(frozen=True, slots=True)
class DiagnoseOptions:
    """How to diagnose.

    reading : how to read the recording. trace : which trace of a .rrd. model : model.json of the simulation as the user
    has it. sim : a trace of the user's own simulation. mass : kg, None when unknown. horizon : of a driven recording's
    windows, s. restoring : what pulls back.
    zero : whether x is measured from the unstretched spring, None for what ``restoring`` suggests. engines : in which
    the fit is shown, the first is what the mismatch is attributed to. preset, dt : of the engines; dt in s, None for
    one that suits the recording (as shipped: the engine's own).

    Raises InputError for a value that does not exist and for options that contradict each other.
    """

    reading: ReadOptions = field(default_factory=ReadOptions)
    trace: str | None = None
    model: Path | None = None
    sim: Path | None = None
    mass: float | None = None
    horizon: float | None = None
    validate: Path | None = None
    restoring: Restoring = Restoring.SPRING
    zero: Zero | None = None
    engines: tuple[str, ...] = ENGINES
    preset: Preset = "tuned"
    dt: float | None = None

    def __post_init__(self) -> None:
        if self.mass is not None:
            positive("--mass", self.mass, "kg")
        if self.horizon is not None:
            positive("--horizon", self.horizon, "s")
        if self.dt is not None:
            positive("--dt", self.dt, "s")
            if self.preset == "as-shipped":
                accepted = "it is accepted with tuned: as shipped has its own"
                raise InputError("--dt", "given with --preset as-shipped", accepted)
        if self.zero == "spring" and self.restoring is not Restoring.SPRING:
            found = f"spring with --restoring {self.restoring.value}"
            raise InputError("--zero", found, "free is accepted there")
        if self.sim is not None and (self.preset == "as-shipped" or self.dt is not None):
            option = "--dt" if self.dt is not None else "--preset as-shipped"
            raise InputError(
                "--sim", f"given with {option}", "one of the two is accepted: a trace has its own settings"
            )
        for name in self.engines:
            choice("--engine", name, registry.names())

    @classmethod
    def chosen(
        cls,
        reading: ReadOptions,
        restoring: str = "spring",
        zero: str | None = None,
        engines: Sequence[str] = (),
        preset: str | None = None,
        **rest: Any,
    ) -> "DiagnoseOptions":
        """As somebody chose, by name; no engine means MuJoCo and PyBullet. Raises InputError listing what there is."""
        choice("--restoring", restoring, tuple(kind.value for kind in Restoring))
        if zero is not None:
            choice("--zero", zero, ZEROS)
        if preset is not None:
            choice("--preset", preset, PRESETS)
        named = tuple(dict.fromkeys(engines)) or ENGINES
        return cls(reading, restoring=Restoring(restoring), zero=zero, engines=named, preset=preset or "tuned", **rest)  # type: ignore[arg-type]

    @property
    def zero_free(self) -> bool:
        """Whether x is measured from an unknown zero."""
        return self.zero == "free" or (self.zero is None and self.restoring is Restoring.PENDULUM)

    def settings(self) -> dict[str, Any]:
        """Every option in force, as results hold it."""
        r = self.reading
        return {
            "columns": r.columns,
            "skip_rows": r.skip_rows,
            "rate_hz": r.rate,
            "from_s": r.start,
            "to_s": r.stop,
            "trace": self.trace,
            "model": None if self.model is None else str(self.model.absolute()),
            "sim": None if self.sim is None else str(self.sim.absolute()),
            "mass_kg": self.mass,
            "horizon_s": self.horizon,
            "validate": None if self.validate is None else str(self.validate.absolute()),
            "restoring": self.restoring.value,
            "zero": "free" if self.zero_free else "spring",
            "engines": list(self.engines),
            "preset": self.preset,
            "dt_s": self.dt,
        }
