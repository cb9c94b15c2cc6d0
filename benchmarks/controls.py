"""What a proof's controls say of the base fit: ``python -m benchmarks.controls DIR`` (reports/proof).

Nothing that the diagnosis estimated is believed: three numbers of every control's slider, and what is left of each
channel, are held against the slider and the noise that the plant put in.
"""

import math
import sys
from collections.abc import Mapping
from pathlib import Path

from scipy.stats import norm

from harness.app.prove.store import VERDICTS, published_verdicts
from harness.core.errors import HarnessError
from harness.proof.plan import CONTROL
from harness.proof.score import Result, Truth
from harness.proof.seal import Ledger
from harness.proof.statistics import Rate
from harness.proof.tally import OURS, parsed

_SLIDER = ("omega_n", "zeta", "x_k")
_ERRORS = 2.0
"""Standard errors within which a number counts as right: 95 % of honest ones."""
_FITTED = 6.0
"""Numbers that a base fit takes from a residual."""
_SCATTER = float(norm.ppf(0.995))
"""Standard deviations of a normal number that are left once in a hundred times."""


def is_noise(ratio: float, points: int, correlation: float) -> bool:
    """Whether a residual's rms over the true noise's is one, within what chance leaves 99 times of a hundred.

    correlation : of first-order noise from one of its points to the next.
    """
    independent = points * (1.0 - correlation**2) / (1.0 + correlation**2)
    return abs(ratio**2 - 1.0) <= _SCATTER * math.sqrt(2.0 / independent) + _FITTED / independent


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


def controls(folder: Path) -> dict[str, Rate]:
    """Rates over the controls of a proof, by what they are the rate of. Raises HarnessError where there is no proof."""
    answers = Ledger.load(folder).content("opened")["answers"]
    truths = {name: answer["value"] for name, answer in answers.items()}
    verdicts = parsed(published_verdicts(folder / VERDICTS / f"{OURS}.jsonl.gz"))
    return base_fit(truths, verdicts)


def main(folder: Path) -> None:
    """Print the rates, one a line."""
    for what, rate in controls(folder).items():
        if rate.value is not None and rate.low is not None and rate.high is not None:
            interval = f"{100.0 * rate.low:.1f} to {100.0 * rate.high:.1f} %"
            print(f"{what}: {100.0 * rate.value:.1f} % of {rate.cases} ({interval})")


if __name__ == "__main__":
    try:
        main(Path(sys.argv[1] if len(sys.argv) > 1 else "reports/proof"))
    except HarnessError as error:
        sys.exit(f"harness: {error}")
