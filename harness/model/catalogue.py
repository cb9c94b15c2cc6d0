"""Writes docs/terms.md from the registry: ``python -m harness.model.catalogue``; a test regenerates and compares."""

import inspect
import math
from pathlib import Path

from harness.model.registry import TERMS
from harness.model.term import Parameter, Slot, Term

TARGET = Path(__file__).resolve().parents[2] / "docs" / "terms.md"

_REALISED = {
    "stribeck": "f_k + (f_s - f_k) exp(-(v/v_s)^2); break-away at f_s.",
    "static-friction": "f_s > f_k only at v = 0.",
    "presliding": "z' = v - sigma0 |v| z/f_k, f = sigma0 z + sigma1 z' (Dahl: sigma1 = 0; with stribeck: LuGre).",
    "regularised-friction": "f_k sat((v + lead a0)/v_r), a0 the acceleration without friction.",
    "impulse": "At the given time v jumps by impulse/m.",
    "sensor-lag": "x is recorded late against a.",
    "sensor-gain": "a is multiplied by the gain.",
    "sensor-bias": "a has the bias added.",
    "sensor-drift": "x gains rate t.",
    "sensor-clipping": "a saturates at the limit.",
}
"""Laws that the kernel or the observation realises itself."""

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

1. Write `harness/model/terms/NAME.py`: a plain function `law(x, v, t, theta, o, out)` that reads its parameters from
   `theta[o]` on and writes its value and its partial derivatives into `out` (columns in `harness/model/law.py`; `out`
   holds zeros). No slices, no allocation: the compiled kernel calls it in its inner loop. With internal states it is
   `law(x, v, w0, w1, theta, o, out)`, and rows 1 and 2 of `out` are their rates.
2. Below it the `TERM`: name, family, slot, parameters with unit and bounds, one plain sentence, and `probes`, the
   parameters at which it is worth a look given the evidence.
3. List it in `harness/model/registry.py`, and give it values in `VALUES` of `tests/support/kernel_cases.py`: its
   partials and its sensitivities are then tested against differences, alone and in pairs.
4. `python -m harness.kernels.generate` and `python -m harness.model.catalogue` write the dispatch and this page.
"""


def _range(p: Parameter) -> str:
    if math.isinf(p.lower) and math.isinf(p.upper):
        return ""
    upper = "" if math.isinf(p.upper) else f" to {p.upper:g}"
    return f", {p.lower:g}{upper}" if upper else f", {'above' if p.positive else 'at least'} {p.lower:g}"


def _section(term: Term) -> list[str]:
    doc = inspect.getdoc(term.law) if term.law is not None else _REALISED[term.name]
    lines = [f"### {term.key}", "", f"Family {term.family}, slot {term.slot}. {term.sentence}", ""]
    lines += ["```text", *(doc or "").splitlines(), "```", ""]
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
