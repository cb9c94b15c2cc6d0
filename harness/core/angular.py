"""Units of a slider that turns: for metres, kilograms and newtons their counterparts about an axis."""

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
