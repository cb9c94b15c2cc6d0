"""Lengths for running text, and what counts as rest."""

AT_REST = 1e-6
"""Creep below this speed in m/s is rest."""


def mm(metres: float) -> str:
    """A length (m) in mm."""
    return f"{metres * 1e3:.3g} mm" if abs(metres) >= 1e-6 else "less than 0.001 mm"
