"""Metrics of a run under names for people, in units of a size to read."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Heading:
    """head : name. unit : shown. factor : how many of it one SI unit is. hint : what it means, in a sentence."""

    head: str
    unit: str = ""
    factor: float = 1.0
    hint: str = ""


_KNOWN = {
    "max_error_m": Heading("largest position error", "mm", 1e3, "largest |x - exact x| over the run"),
    "rest_error_m": Heading("error at rest", "mm", 1e3, "last position minus the exact rest position"),
    "stick_time_s": Heading("stops at", "s", 1.0, "time from which the slider does not move any more"),
    "creep_m_s": Heading("creep", "mm/s", 1e3, "mean speed while the exact slider rests"),
    "half_cycles": Heading("half-cycles", "", 1.0, "until it rests"),
    "reversal_lead_s": Heading("friction leads by", "ms", 1e3, "by how much friction reverses before the speed does"),
    "energy_error": Heading("energy error", "", 1.0, "largest error of the energy balance over the starting energy"),
    "lift_m": Heading("lift", "mm", 1e3, "largest height of the box above the floor"),
    "drift_m": Heading("drift", "mm", 1e3, "distance from the start at the end, elastic give included"),
    "period_s": Heading("period", "s", 1.0, "mean time from slip to slip"),
    "stick_fraction": Heading("share that sticks", "", 1.0, "share of whole periods with friction below its limit"),
    "near_belt_fraction": Heading("share that rides", "", 1.0, "share of whole periods within 1 % of the belt's speed"),
    "stick_deviation_m_s": Heading("slip while it sticks", "mm/s", 1e3, "median |v - belt speed| over what sticks"),
    "amplitude_m": Heading("amplitude", "mm", 1e3, "half of the distance between the turning points"),
    "stop_fraction": Heading("share that stops", "", 1.0, "share of the last periods with friction below its limit"),
    "normal_error": Heading("normal force error", "", 1.0, "largest |N/(m g) - 1|; 1: the box leaves the floor"),
    "mu_v_over_g_s": Heading("mu v / g", "ms", 1e3, "friction coefficient x largest speed / g"),
}
_UNITS = {"_m_s": ("mm/s", 1e3), "_m": ("mm", 1e3), "_s": ("s", 1.0)}
DECAY = tuple(_KNOWN)[:7]
"""Metrics of a free decay, shown even where there is no such figure."""


def heading(metric: str) -> Heading:
    """What a metric is called; one that is not known here is called by its name, in the unit at its end."""
    if metric in _KNOWN:
        return _KNOWN[metric]
    for ending, (unit, factor) in _UNITS.items():
        if metric.endswith(ending):
            return Heading(metric.removesuffix(ending).replace("_", " "), unit, factor)
    return Heading(metric.replace("_", " "))
