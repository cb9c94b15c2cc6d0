"""How often what stands out beside an unexplained rest is true: ``python -m benchmarks.parts DIR``.

Of every published verdict that nothing explains the largest part is taken; it is true where the machine has such an
effect, or one that the plant says comes to the same.
"""

import sys
from pathlib import Path
from typing import Any

from harness.app.prove.store import VERDICTS, published_verdicts
from harness.core.errors import HarnessError
from harness.diagnosis.rules import PART_SPANS, SHARE_OF_MISFIT
from harness.proof.machines.score import Result, Truth
from harness.proof.seal import Ledger
from harness.proof.statistics import Rate
from harness.proof.tally import OURS, parsed

RATIOS = (0.3, 0.5, 0.7, 0.9, float("inf"))
"""Of another law's share, up to which the largest part stands out."""


def part(said: Result) -> tuple[str, float] | None:
    """The largest part, and the largest share of another law over its own; None where none is held out everywhere."""
    parts: list[dict[str, Any]] = [m for m in said.get("mechanisms", []) if m["grade"] in ("part", "minor")]
    if said.get("verdict") != "unexplained" or not parts or parts[0]["alternatives"]:
        return None
    name, share, blocks = parts[0]["name"], parts[0]["share"], (parts[0]["holdout"] or {}).get("blocks", [])
    if share < SHARE_OF_MISFIT.value or len(blocks) < PART_SPANS.value or max(blocks) >= 1.0:
        return None
    return name, max((e.get("share") or 0.0 for e in said["evidence"] if e["name"] != name), default=0.0) / share


def true_in(name: str, truth: Truth) -> bool:
    """Whether a machine has an effect."""
    return name in {truth.get("dominant"), *truth.get("minor", {}), *truth.get("may_name", []), *truth.get("right", [])}


def main(folder: Path) -> None:
    """Print how many parts stand out, and how many of them are true, one ratio a line."""
    answers = Ledger.load(folder).content("opened")["answers"]
    verdicts = parsed(published_verdicts(folder / VERDICTS / f"{OURS}.jsonl.gz"))
    found = [(part(verdicts.get(name, {})), answer["value"]) for name, answer in answers.items()]
    for ratio in RATIOS:
        rate = Rate.of([true_in(seen[0], truth) for seen, truth in found if seen and seen[1] <= ratio])
        if rate.value is not None and rate.low is not None and rate.high is not None:
            interval = f"{100.0 * rate.low:.0f} to {100.0 * rate.high:.0f} %"
            print(f"another law takes at most {ratio:g} of it: {rate.hits} of {rate.cases} true ({interval})")


if __name__ == "__main__":
    try:
        main(Path(sys.argv[1] if len(sys.argv) > 1 else "reports/proof-machines"))
    except HarnessError as error:
        sys.exit(f"harness: {error}")
