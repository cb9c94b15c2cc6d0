"""What controls say of the base fit of a diagnosis, against the slider and the noise that the plant put in.

Nothing that the diagnosis estimated is believed: three numbers of every control's slider, and what is left of each
channel.
"""

from collections.abc import Mapping

from harness.proof.plan import CONTROL
from harness.proof.score import Result, Truth
from harness.proof.statistics import Rate, is_noise

_SLIDER = ("omega_n", "zeta", "x_k")
_ERRORS = 2.0
"""Standard errors within which a number counts as right: 95 % of honest ones."""


def base_fit(truths: Mapping[str, Truth], verdicts: Mapping[str, Result]) -> dict[str, Rate]:
    """Rates over the controls, by what they are the rate of. truths, verdicts : by name of the recording."""
    alarm: list[bool] = []
    within: list[bool] = []
    held: dict[str, list[bool]] = {name: [] for name in _SLIDER}
    for name, truth in truths.items():
        said = verdicts.get(name, {})
        if truth["group"] != CONTROL:
            continue
        alarm.append(said.get("verdict") != "adequate")
        if "baseline" not in said:
            continue
        within += [
            is_noise(said["baseline"]["rmse"][c] / truth["noise"][c], truth["points"], truth["noise_correlation"])
            for c in truth["channels"]
        ]
        for parameter in _SLIDER:
            value = said["baseline"]["parameters"].get(parameter) or {}
            if value.get("stderr") is not None:
                held[parameter].append(abs(value["value"] - truth[parameter]) <= _ERRORS * value["stderr"])
    return {
        "false alarms": Rate.of(alarm),
        "mean square of what is left within 99 % of its scatter about the true noise's": Rate.of(within),
        **{f"{parameter} within two standard errors": Rate.of(hits) for parameter, hits in held.items()},
        "all three within two standard errors": Rate.of([hit for hits in held.values() for hit in hits]),
    }
