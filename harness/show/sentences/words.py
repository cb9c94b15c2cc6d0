"""Lengths and names for running text, and what counts as rest."""

AT_REST = 1e-6
"""Creep below this speed in m/s is rest."""


def mm(metres: float, angular: bool = False) -> str:
    """A length (m) in mm; an angle (rad) in mrad."""
    unit = "mrad" if angular else "mm"
    return f"{metres * 1e3:.3g} {unit}" if abs(metres) >= 1e-6 else f"less than 0.001 {unit}"


_ENGINES = {
    "mujoco": "MuJoCo",
    "pybullet": "PyBullet",
    "dart": "DART",
    "rapier": "Rapier",
    "drake": "Drake",
    "physx": "PhysX",
    "newton": "Newton",
    "reference": "the reference",
}


def engine_name(name: str) -> str:
    """An engine as its makers write it; one that is not known here by its own name."""
    return _ENGINES.get(name, name)
