"""What a proof's controls say of the base fit: ``python -m harness.app.prove.controls DIR`` (reports/proof)."""

import sys
from pathlib import Path

from harness.app.prove.store import VERDICTS, published_verdicts
from harness.core.errors import HarnessError
from harness.proof.base_fit import base_fit
from harness.proof.seal import Ledger
from harness.proof.statistics import Rate
from harness.proof.tally import OURS, parsed


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
