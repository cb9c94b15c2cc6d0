"""Recordings as files."""

from io import StringIO
from pathlib import Path

import numpy as np

from harness.proof.plant.cases import Case


def csv_text(case: Case) -> str:
    """t, the channels and u where driven, in SI with nine significant digits; an angle says so in its header."""
    angular = case.base.restoring == "pendulum" or "pendulum-stiffness" in case.mechanisms
    names = ["t", *(c for c in ("x", "a", "u") if c in case.recorded)]
    unit = {"x": " [rad]", "a": " [rad/s^2]"} if angular else {}
    header = ",".join(name + unit.get(name, "") for name in names)
    text = StringIO()
    np.savetxt(
        text, np.column_stack([case.recorded[n] for n in names]), fmt="%.9g", delimiter=",", header=header, comments=""
    )
    return text.getvalue()


def write_csv(case: Case, path: Path) -> None:
    """Write ``csv_text`` to a file."""
    path.write_text(csv_text(case), encoding="utf-8")
