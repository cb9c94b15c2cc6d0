"""Recordings and answers as files."""

from pathlib import Path

import numpy as np

from harness.proof.plant.cases import Case


def write_csv(case: Case, path: Path) -> None:
    """t, the channels and u where driven, in SI with nine significant digits; an angle says so in its header."""
    angular = case.base.restoring == "pendulum" or "pendulum-stiffness" in case.mechanisms
    names = ["t", *(c for c in ("x", "a", "u") if c in case.recorded)]
    unit = {"x": " [rad]", "a": " [rad/s^2]"} if angular else {}
    header = ",".join(name + unit.get(name, "") for name in names)
    np.savetxt(
        path, np.column_stack([case.recorded[n] for n in names]), fmt="%.9g", delimiter=",", header=header, comments=""
    )
