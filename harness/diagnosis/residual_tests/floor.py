"""How rare a mean square is over a floor that was itself estimated."""

from scipy.special import fdtrc


def over_floor(chi2: float, k: float, m: float) -> float:
    """Chance of a mean square this large over a floor that has m degrees of freedom."""
    return float(fdtrc(k, m, chi2 / k)) if k >= 1.0 else 1.0
