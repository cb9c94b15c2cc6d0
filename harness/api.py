"""A few names for programs: load a recording, diagnose it, simulate a model. Results are those of the command.

docs/api.md has a worked example.
"""

from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.results.diagnosis import DiagnosisResult
from harness.results.model import ModelDocument

__all__ = ["DiagnosisResult", "ModelDocument", "Recording", "Trajectory", "diagnose", "load", "simulate"]


def load(
    path: str | PathLike[str],
    *,
    columns: str | None = None,
    skip_rows: int = 0,
    rate: float | None = None,
    start: float | None = None,
    stop: float | None = None,
    trace: str | None = None,
) -> Recording:
    """Read a recording of any accepted format, in SI units.

    columns : as --columns, "t=t,x=qm[mm]". rate : Hz, where no column gives the time. start, stop : s, the part to
    keep. trace : which one of a .rrd. Raises InputError naming what is wrong, and where.
    """
    from harness.app.reading import ReadOptions, read

    return read(Path(path), ReadOptions(columns, skip_rows, rate, start, stop), trace)


def diagnose(
    recording: Recording,
    *,
    out: str | PathLike[str] | None = None,
    model: str | PathLike[str] | None = None,
    sim: str | PathLike[str] | None = None,
    mass: float | None = None,
    restoring: str = "spring",
    zero: str | None = None,
    engines: Sequence[str] = (),
    preset: str | None = None,
    dt: float | None = None,
) -> DiagnosisResult:
    """Find which physics viscous and Coulomb friction leave out of a recording, and the model that has it.

    out : folder for report, trace and models, as the command leaves them; None writes nothing. model : model.json of
    the simulation as you have it. sim : a trace of it. mass : kg. restoring : "spring", "pendulum" or "none". zero :
    "spring" or "free". engines, preset, dt (s) : in which the fit is shown; MuJoCo and PyBullet, tuned.

    Raises InputError for a recording or an option that cannot be used, SimulationError when no model could be
    simulated, StoreError when ``out`` cannot be written.
    """
    from harness.app.diagnose import answer, deliver
    from harness.app.diagnose_options import DiagnoseOptions
    from harness.app.reading import ReadOptions

    options = DiagnoseOptions.chosen(
        ReadOptions(),
        restoring,
        zero,
        engines,
        preset,
        model=None if model is None else Path(model),
        sim=None if sim is None else Path(sim),
        mass=mass,
        dt=dt,
    )
    return answer(recording, options) if out is None else deliver(recording, options, Path(out))


def simulate(model: ModelDocument | Mapping[str, Any] | str | PathLike[str], t: ArrayLike) -> Trajectory:
    """The motion of a model in the compiled reference.

    model : as a result holds it (``result.refined_model``), its plain data, or a model.json. t : (n,), s, increasing.
    Raises InputError for what is no model, SimulationError when it cannot be followed.
    """
    from harness.app.simulate import motion_of

    return motion_of(model, np.asarray(t, dtype=np.float64))
