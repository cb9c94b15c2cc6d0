"""Recordings of machines as files: a header with units as their users write them."""

from io import StringIO

import numpy as np

from harness.proof.machines.cases import Messy

_DEGREE, _MILLI = 180.0 / np.pi, 1e3


def units(case: Messy) -> dict[str, tuple[str, float]]:
    """Unit of each column and its number in the SI unit; degrees and millimetres where the machine is of that kind."""
    t = ("s", 1.0)
    if case.rig.kind.angular:
        if case.rig.kind.name in ("encoder-pendulum", "torsion-wheel"):
            return {"t": t, "x": ("deg", _DEGREE), "v": ("deg/s", _DEGREE)}
        return {"t": t, "x": ("rad", 1.0), "v": ("rad/s", 1.0)}
    if case.rig.kind.name in ("rubber-stage", "cylinder"):
        return {"t": t, "x": ("mm", _MILLI), "a": ("m/s^2", 1.0), "u": ("N", 1.0)}
    return {"t": t, "x": ("m", 1.0), "a": ("m/s^2", 1.0), "u": ("N", 1.0)}


def csv_text(case: Messy) -> str:
    """t, the channels, and u where driven, with nine significant digits."""
    known = units(case)
    names = [name for name in ("t", "x", "v", "a", "u") if name in case.recorded]
    table = np.column_stack([case.recorded[name] * known[name][1] for name in names])
    text = StringIO()
    header = ",".join(f"{name} [{known[name][0]}]" for name in names)
    np.savetxt(text, table, fmt="%.9g", delimiter=",", header=header, comments="")
    return text.getvalue()
