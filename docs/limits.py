"""Writes the tables of docs/limits.md, what the published proofs missed: python docs/limits.py."""

import json
import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from harness.proof.paths.score import PLAIN

ROOT = Path(__file__).resolve().parents[1]
TARGET = ROOT / "docs" / "limits.md"
BEGIN, END = "<!-- written by python docs/limits.py: {} -->\n", "<!-- end -->"
OUTSIDE = {
    "alien-heating": "friction that changes with the work done against it",
    "alien-inertial-load": "friction that follows the net force",
    "alien-random-force": "a random force",
    "alien-rattle": "a mass that rattles in a cage on the slider",
    "alien-speed-stiffness": "a spring that stiffens or softens with speed",
    "alien-structural-damping": "friction that grows with the distance from the middle",
}
"""Laws of the bench that the catalogue does not have, in words."""


def _cases(proof: str, group: str) -> list[Mapping[str, Any]]:
    result = json.loads((ROOT / "reports" / proof / "result.json").read_text(encoding="utf-8"))
    return [case for case in result["cases"] if case["group"] == group]


def _plain(proof: str) -> list[Mapping[str, Any]]:
    """Of a proof on all ways what its recordings could tell, by the way."""
    # a result has the chi-square, twice the effective samples that are asked for
    told = (case for case in _cases(proof, "path") if case["loss"] > 2.0 * PLAIN)
    return [{**case, "hidden": [f"{case['setting']}: {case['hidden'][0]}"]} for case in told]


def _rows(cases: Iterable[Mapping[str, Any]], words: Mapping[str, str]) -> list[str]:
    """A row for each hidden effect that was missed at least once: how often, and what was answered then."""
    missed, count = defaultdict[str, Counter[str]](Counter), Counter[str]()
    for case in cases:
        hidden = " + ".join(case["hidden"])
        count[hidden] += 1
        if not case["right"]:
            missed[hidden][case["said"]] += 1
    ordered = sorted(missed, key=lambda name: (-missed[name].total() / count[name], name))
    return [
        f"| {words.get(name, name)} | {missed[name].total()} of {count[name]} | "
        f"{', '.join(f'{said} ({n})' for said, n in missed[name].most_common())} |"
        for name in ordered
    ]


TABLES = {
    "single effects": ("effect", _cases("proof", "single"), {}),
    "pairs": ("effects", _cases("proof", "pair"), {}),
    "outside": ("what acts", _cases("proof", "outside"), OUTSIDE),
    "ways": ("way, effect", _plain("proof-paths"), {}),
    "machines": ("dominant effect", _cases("proof-machines", "main"), {}),
}


def text(page: str) -> str:
    """The page with its tables as the published proofs have them now."""
    for name, (head, cases, words) in TABLES.items():
        begin = BEGIN.format(name)
        table = "\n".join([f"| {head} | missed | answered instead |", "|---|---|---|", *_rows(cases, words)])
        whole = f"{re.escape(begin)}.*?{END}"
        page = re.sub(whole, f"{begin}{table}\n{END}", page, count=1, flags=re.DOTALL)
    return page


if __name__ == "__main__":
    TARGET.write_text(text(TARGET.read_text(encoding="utf-8")), encoding="utf-8")
