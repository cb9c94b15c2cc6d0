"""Writes harness/kernels/dispatch.py from the registry: ``python -m harness.kernels.generate``.

Every term is examined first (harness.kernels.examine), those of other packages too.
"""

from dataclasses import dataclass
from pathlib import Path

from harness.kernels.layout import BRISTLES, INTERNAL, LEVELS, MODULATIONS, SMOOTH, SMOOTHED
from harness.model.term import Term

_WIDTH = 120
TARGET = Path(__file__).with_name("dispatch.py")
_TYPES = {"number": "int", "side": "int", "o": "int", "theta": "FloatArray", "out": "FloatArray"}


@dataclass(frozen=True, slots=True)
class Ladder:
    """One generated function: name, docstring, name of its terms in harness.kernels.layout, what their laws are given.

    optional : an argument that a law may leave out, and so depend on it in no way.
    """

    name: str
    doc: str
    group: str
    terms: tuple[Term, ...]
    arguments: tuple[str, ...]
    optional: str = ""

    def call(self, term: Term) -> str:
        """The arguments of a term's law. Raises TypeError when they are not those of its slot."""
        assert term.law is not None
        code = term.law.__code__
        own = code.co_varnames[: code.co_argcount]
        if own not in (self.arguments, tuple(a for a in self.arguments if a != self.optional)):
            raise TypeError(f"term {term.key}: law({', '.join(own)}); expected law({', '.join(self.arguments)})")
        return ", ".join(own)

    def lines(self) -> list[str]:
        """The laws and the function."""
        aliases, keys = [_alias(term) for term in self.terms], [f'"{term.key}"' for term in self.terms]
        if len(keys) == 1:
            lines = [f"({aliases[0]},) = laws({self.group}, {keys[0]})"]
        else:
            known = ["(", *(f"    {alias}," for alias in aliases), ") = "] if aliases else [""]
            lines = [*known[:-1], known[-1] + "laws(", *(f"    {word}," for word in (self.group, *keys)), ")"]
        signature = ", ".join(f"{a}: {_TYPES.get(a, 'float')}" for a in ("number", *self.arguments))
        head = f"def {self.name}({signature}) -> None:"
        wrapped = [f"def {self.name}(", f"    {signature}", ") -> None:"]
        lines += ["", "", "@lean", *([head] if len(head) <= _WIDTH else wrapped), f'    """{self.doc}"""']
        for number, term in enumerate(self.terms):
            lines.append(f"    {'elif' if number else 'if'} number == {number}:")
            lines.append(f"        {_alias(term)}({self.call(term)})")
        return [*lines, "", ""]


_TAIL = ("theta", "o", "out")
LADDERS = (
    Ladder("speed_level", "Level of friction by speed, and its partials.", "LEVELS", LEVELS, ("v", *_TAIL)),
    Ladder("modulation", "Factor on f_k and its partials.", "MODULATIONS", MODULATIONS, ("x", "v", "t", *_TAIL), "t"),
    Ladder(
        "bristle_law", "Friction of a bristle (row 0), its rate, and partials.", "BRISTLES", BRISTLES,
        ("v", "side", "z", "level", *_TAIL),
    ),
    Ladder(
        "smoothed_law", "Friction without stick and without a state, and its partials.", "SMOOTHED", SMOOTHED,
        ("v", "a", "level", *_TAIL),
    ),
    Ladder("smooth", "Force on the left side and its partials.", "SMOOTH", SMOOTH, ("x", "v", "t", *_TAIL), "t"),
    Ladder(
        "internal", "Force (row 0), rates of the states, and partials.", "INTERNAL", INTERNAL,
        ("x", "v", "w0", "w1", *_TAIL),
    ),
)  # fmt: skip


def _alias(term: Term) -> str:
    return "_" + term.key.replace("-", "_").replace(":", "_")


def text() -> str:
    """The dispatch file as it follows from the registry."""
    lines = [
        '"""Dispatch of laws by number; generated from the registry by harness.kernels.generate, do not edit."""',
        "",
        "from harness.core.arrays import FloatArray",
        "from harness.core.jit import lean",
        "from harness.kernels.laws import laws",
        f"from harness.kernels.layout import {', '.join(sorted(ladder.group for ladder in LADDERS))}",
        "",
    ]
    for ladder in LADDERS:
        lines += ladder.lines()
    return "\n".join(lines).rstrip("\n") + "\n"


if __name__ == "__main__":
    from harness.kernels.examine import examine
    from harness.model.registry import TERMS

    for entry in TERMS:
        examine(entry)
    TARGET.write_text(text(), encoding="utf-8")
