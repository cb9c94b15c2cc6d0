"""Writes docs/terms.md from the registry: ``python -m harness.model.catalogue``; a test regenerates and compares."""

from pathlib import Path

from harness.model.registry import TERMS
from harness.model.term import Slot, Term

TARGET = Path(__file__).resolve().parents[2] / "docs" / "terms.md"

_SLOTS = {
    Slot.SMOOTH: "a sum of forces on the left side of m x'' + c x' + k x + f = u",
    Slot.FRICTION_LAW: "how dry friction acts; one law (Coulomb when there is none)",
    Slot.FRICTION_LEVEL: "the level f_k as a function of speed; one curve",
    Slot.FRICTION_MODULATION: "factors on the level of friction, a product never below 0",
    Slot.BREAK_AWAY: "the force at which it breaks away, never below the friction that then sets in; one",
    Slot.INTERNAL: "internal states that couple in; a sum",
    Slot.EVENT: "events in time",
    Slot.OBSERVATION: "what a sensor makes of x and a; a composition",
}

_ADD = """\
## How to add a term

All that is known of a term stands in its file, and nothing else knows its name.

1. Write `harness/model/terms/NAME.py`; it is found by being there. A law is a plain function that reads its parameters
   from `theta[o]` on and writes its value and its partial derivatives into `out`, which holds zeros; what it is given
   follows from its slot (`harness/model/law.py`). A law that takes `t` is one that changes in time. No slices, no
   allocation: the compiled kernel calls it in its inner loop.
2. Below it a `Term` (`harness/model/term.py`): name, family, slot, parameters with unit and bounds, one plain sentence,
   `example` values at which it matters, and `probes`, the parameters at which it is worth a look given the evidence.
   More only where it applies: where it acts, elements that an engine's joint may have words for, internal states that a
   recorded motion implies, what recording tells it from another.
3. `python -m harness.kernels.generate` examines every term (partials against differences, what its slot expects) and
   writes the dispatch. `python -m harness.model.catalogue` writes this page; `python docs/signatures.py NAME`, then
   `python docs/term_pages.py`, that of the term; `python -m harness.diagnosis.rules > docs/rules.md` the one on which
   the number of names stands. Tests of the kernel, of the engines and of the files take the term from the catalogue.

A package of your own does the same: an entry point of group `harness.terms` whose value is the `Term`
(`magnet = "my_package.magnet:TERM"`), and `python -m harness.kernels.generate` once after it is installed or taken
away; until then the reference is refused with a message that says so. [extending.md](extending.md) shows one whole.
"""


def page_of(term: Term) -> str:
    """The page of a term in docs/terms, without its ending: one for all laws that share a name."""
    return f"terms/{term.name}"


def text() -> str:
    """The page as it follows from the registry."""
    lines = [
        "# The catalogue of terms",
        "",
        "Generated from the registry by `python -m harness.model.catalogue`. The page of a term has its law,",
        "what viscous and Coulomb friction leave of a motion that has it, and what it is confused with.",
        "",
    ]
    for slot, what in _SLOTS.items():
        lines += [
            f"## Slot {slot}",
            "",
            what[0].upper() + what[1:] + ".",
            "",
            "| term | family | law |",
            "|---|---|---|",
        ]
        for term in TERMS:
            if term.slot is slot:
                law = term.said.splitlines()[0].replace("|", "\\|")
                lines.append(f"| [{term.key}]({page_of(term)}.md) | {term.family} | {law} |")
        lines.append("")
    return "\n".join([*lines, _ADD])


if __name__ == "__main__":
    TARGET.write_text(text(), encoding="utf-8")
