"""A number with its standard error and unit, or the reason why there is none."""

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Quantity:
    """An estimate.

    value : None when the estimate was refused. stderr : one standard error, None only with a reason.
    unit : SI symbol, "1" for a pure number. why : the reason for what is missing.
    systematic : what effects that could not be seen, or another form of a named law, could shift it by, None where that
    was not asked.
    """

    value: float | None
    stderr: float | None
    unit: str
    why: str | None = None
    systematic: float | None = None

    def __post_init__(self) -> None:
        if self.value is not None and not math.isfinite(self.value):
            raise ValueError(f"a quantity is finite or refused, not {self.value}")
        if (self.value is None or self.stderr is None) and not self.why:
            raise ValueError("a quantity without value or standard error says why")

    @classmethod
    def refused(cls, unit: str, why: str) -> "Quantity":
        """An estimate that could not be made, with the reason."""
        return cls(None, None, unit, why)

    def __str__(self) -> str:
        """Value and standard error as a sentence shows them, the value to the error's last digit.

        The error has two digits where the first is 1 or 2, else one. Very large and very small values share a power
        of ten: (3.17 +- 0.12)e-05 m.
        """
        if self.value is None:
            return "unknown"
        unit = "" if self.unit == "1" else f" {self.unit}"
        if not self.stderr:
            return f"{self.value:.4g}{unit}"
        size = max(abs(self.value), self.stderr)
        power = math.floor(math.log10(size))
        power = power if power < _SMALLEST or power > _LARGEST else 0
        value, error = self.value / 10.0**power, self.stderr / 10.0**power
        decimals = _decimals(error)
        # a value below its error keeps the error's digits, and one below its last digit has no sign
        shown, places = round(value, decimals) + 0.0, max(decimals, 0)
        text = f"{shown:.{places}f} +- {round(error, decimals):.{places}f}"
        return f"({text})e{power:+03d}{unit}" if power else f"{text}{unit}"


_SMALLEST, _LARGEST = -4, 6


def _decimals(error: float) -> int:
    """Decimals to which an error is shown."""
    one = -math.floor(math.log10(error))
    return one + 1 if error * 10.0**one < _TWO_DIGITS_BELOW else one


_TWO_DIGITS_BELOW = 2.95


def outweighs(systematic: float | None, stderr: float | None) -> bool:
    """Whether a systematic error is larger than the standard one, and to be shown beside it."""
    return (systematic or 0.0) > (stderr or 0.0)


_ABOUT_AN_AXIS = {
    "m": "rad",
    "m/s": "rad/s",
    "m/s^2": "rad/s^2",
    "1/m": "1/rad",
    "kg": "kg m^2",
    "kg/m": "N m s^2/rad^2",
    "N": "N m",
    "N s": "N m s",
    "N s/m": "N m s/rad",
    "N (s/m)^p": "N m (s/rad)^p",
    "N/m": "N m/rad",
    "N/m^2": "N m/rad^2",
    "N/m^3": "N m/rad^3",
}


def about_an_axis(unit: str) -> str:
    """The unit of a turning slider's parameter that is ``unit`` for one that slides; others stay as they are."""
    return _ABOUT_AN_AXIS.get(unit, unit)


def parameter_unit(unit: str, angular: bool, mass_known: bool) -> str:
    """A parameter's unit: about an axis where it turns, a force's or a mass's per unit mass where that is unknown."""
    with_mass = unit.split("/", maxsplit=1)[0].split(" ", maxsplit=1)[0] in ("N", "kg")
    own, mass = (about_an_axis(unit), "kg m^2") if angular else (unit, "kg")
    return f"{own} per {mass}" if with_mass and not mass_known else own
