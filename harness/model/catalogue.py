"""Writes docs/terms.md from the registry: ``python -m harness.model.catalogue``; a test regenerates and compares."""

import math
from pathlib import Path

from harness.model.registry import TERMS
from harness.model.term import Parameter, Slot, Term

TARGET = Path(__file__).resolve().parents[2] / "docs" / "terms.md"

_SLOTS = {
    Slot.SMOOTH: "a sum of forces on the left side of m x'' + c x' + k x + f = u",
    Slot.FRICTION_LAW: "how dry friction acts; one law (Coulomb when there is none)",
    Slot.FRICTION_LEVEL: "f_k as a function of speed; one curve",
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
   writes the dispatch; `python -m harness.model.catalogue` writes this page, and
   `python -m harness.diagnosis.rules > docs/rules.md` another on which the number of names stands. The tests of the
   kernel, of the engines and of the files take the term from the catalogue.

A package of your own does the same: an entry point of group `harness.terms` whose value is the `Term`
(`magnet = "my_package.magnet:TERM"`), and `python -m harness.kernels.generate` once after it is installed or taken
away; until then the reference is refused with a message that says so. [extending.md](extending.md) shows one whole.
"""


def _range(p: Parameter) -> str:
    if math.isinf(p.lower) and math.isinf(p.upper):
        return ""
    upper = "" if math.isinf(p.upper) else f" to {p.upper:g}"
    return f", {p.lower:g}{upper}" if upper else f", {'above' if p.positive else 'at least'} {p.lower:g}"


def _section(term: Term) -> list[str]:
    lines = [f"### {term.key}", "", f"Family {term.family}, slot {term.slot}. {term.sentence}", ""]
    lines += ["```text", *term.said.splitlines(), "```", ""]
    for p in term.parameters:
        none = "" if p.none is None else f"; no effect at {p.none:g}"
        lines.append(f"- `{p.name}` [{p.unit}]{_range(p)}{none}")
    return [*lines, ""] if term.parameters else lines


def text() -> str:
    """The page as it follows from the registry."""
    lines = [
        "# The catalogue of terms",
        "",
        "Generated from the registry by `python -m harness.model.catalogue`. Units are those with a known mass;",
        "without one, forces and their parameters are per unit mass.",
        "",
    ]
    for slot, what in _SLOTS.items():
        lines += [f"## Slot {slot}: {what}", ""]
        for term in TERMS:
            if term.slot is slot:
                lines += _section(term)
    return "\n".join([*lines, _ADD])


if __name__ == "__main__":
    TARGET.write_text(text(), encoding="utf-8")
