"""How rare a mean square is over a floor that was itself estimated."""

from collections.abc import Callable

from scipy.special import fdtrc


def over_floor(chi2: float, k: float, m: float) -> float:
    """Chance of a mean square this large over a floor that has m degrees of freedom."""
    return float(fdtrc(k, m, chi2 / k)) if k >= 1.0 else 1.0


def spared(chance: Callable[[float], float], chi2: float, spare: float) -> float:
    """Chance of a chi-square of which ``spare`` may be left besides by what is no structure, all of it here.

    chance : of a chi-square. What is spared makes a test say nothing, never that there is too little.
    """
    plain = chance(chi2)
    return plain if spare <= 0.0 else max(plain, min(chance(max(chi2 - spare, 0.0)), 0.5))
