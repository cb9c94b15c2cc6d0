"""Writes harness/kernels/dispatch.py from the registry: ``python -m harness.kernels.generate``.

Every term is examined first, those of other packages too, whether it is what it says: partials against differences,
time, push, and what its slot expects of its law.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.core.arrays import FloatArray
from harness.kernels.layout import BRISTLES, INTERNAL, LEVELS, MODULATIONS, SMOOTH, SMOOTHED
from harness.model.law import (
    COLUMNS,
    D_FREE,
    D_INTERNAL,
    D_LEVEL,
    D_MASS,
    D_PARAMETER,
    D_STIFFNESS,
    D_T,
    D_V,
    D_X,
    FIRST_TERM,
    INTERNAL_COLUMNS,
    KINETIC,
    MASS,
    STIFFNESS,
    V_SCALE,
    VALUE,
)
from harness.model.term import Slot, Term

_POINTS, _STEP, _CLOSE = 25, 1e-6, 1e-7
_BY_ARGUMENT = {"x": D_X, "v": D_V, "t": D_T, "a": D_FREE, "level": D_LEVEL, "z": D_INTERNAL}
_BY_ARGUMENT |= {"w0": D_INTERNAL, "w1": D_INTERNAL + 1}
_BY_BASE = {
    Slot.FRICTION_LEVEL: {KINETIC: D_LEVEL},
    Slot.FRICTION_LAW: {},
    Slot.INTERNAL: {MASS: D_MASS},
    Slot.SMOOTH: {MASS: D_MASS, STIFFNESS: D_STIFFNESS},
    Slot.FRICTION_MODULATION: {},
}
"""Base parameters that a law may read, and the columns of its partials by them."""


class _Law:
    """A term's law as a function of one vector: its own arguments, the base parameters it may read, its parameters."""

    def __init__(self, term: Term) -> None:
        assert term.law is not None
        self._law: Callable[..., None] = term.law
        code = term.law.__code__
        self.arguments = [a for a in code.co_varnames[: code.co_argcount] if a not in ("theta", "o", "out", "side")]
        self._sided = "side" in code.co_varnames[: code.co_argcount]
        base = _BY_BASE[term.slot]
        self._places = [*base, *range(FIRST_TERM, FIRST_TERM + len(term.parameters))]
        own = range(D_PARAMETER, D_PARAMETER + len(term.parameters))
        self.columns = [*(_BY_ARGUMENT[a] for a in self.arguments), *base.values(), *own]
        self._shape = (3, INTERNAL_COLUMNS) if term.internal else (1, COLUMNS)
        self._theta = np.zeros(FIRST_TERM + len(term.parameters))
        self._theta[[MASS, STIFFNESS, KINETIC, V_SCALE]] = 1.7, 80.0, 2.0, 5.0
        self._theta[FIRST_TERM:] = term.example

    def at(self, **given: float) -> FloatArray:
        """The vector of these arguments (others 0) and the example's parameters."""
        return np.array([*(given.get(a, 0.0) for a in self.arguments), *self._theta[self._places]])

    def rows(self, at: FloatArray, side: int = 1) -> FloatArray:
        """What the law writes, (1 or 3, columns)."""
        theta, out = self._theta.copy(), np.zeros(self._shape)
        theta[self._places] = at[len(self.arguments) :]
        arguments = dict(zip(self.arguments, at.tolist(), strict=False)) | ({"side": side} if self._sided else {})
        self._law(**arguments, theta=theta, o=FIRST_TERM, out=out if len(out) > 1 else out[0])
        return out


def examine(term: Term) -> None:
    """Raise TypeError, saying what is wrong, for a term whose law and whose statements do not agree."""
    if term.law is None:
        return
    law = _Law(term)
    draws = np.random.default_rng(3).uniform(-1.3, 1.3, (_POINTS, len(law.arguments)))
    for draw in draws:
        given = dict(zip(law.arguments, draw.tolist(), strict=True))
        if "level" in given:
            given["level"] = 2.0 + given["level"]
        _partials(term, law, law.at(**given), 1 if given["v"] >= 0.0 else -1)
    _slot(term, law)


def _partials(term: Term, law: _Law, at: FloatArray, side: int) -> None:
    """Compare every column with central differences by the coordinate that it belongs to."""
    rows = law.rows(at, side)
    scale = 1.0 + float(np.abs(rows[:, VALUE]).max())
    for i, column in enumerate(law.columns):
        shift = np.zeros_like(at)
        shift[i] = _STEP * max(1.0, abs(at[i]))
        change = (law.rows(at + shift, side) - law.rows(at - shift, side))[:, VALUE] / (2.0 * shift[i])
        if np.abs(rows[:, column] - change).max() > _CLOSE * (scale + np.abs(change).max()):
            names = [*law.arguments, *(f"theta[{p}]" for p in _BY_BASE[term.slot]), *term.names]
            found = f"the partial by {names[i]} is {rows[:, column]}, differences give {change}"
            raise TypeError(f"term {term.key}: {found}")
    if np.any(np.delete(rows, [VALUE, *law.columns], axis=1) != 0.0):
        raise TypeError(f"term {term.key}: it writes a partial by what it is not given")


def _slot(term: Term, law: _Law) -> None:
    """What the kernel takes for granted of a law in its slot."""
    resting = [float(law.rows(law.at(t=t))[0, VALUE]) for t in (0.0, 0.3, 1.7)] if term.slot is Slot.SMOOTH else []
    wrong = ""
    if any(resting) != (term.push is not None):
        wrong = "push names the size of a force on a slider at rest at x = 0, and there is " + (
            "one" if any(resting) else "none"
        )
    if term.slot is Slot.FRICTION_LEVEL and law.rows(law.at())[0, VALUE] != term.example[0]:
        wrong = "the level at v = 0 must be the first parameter, the force at which it breaks away"
    if term.slot is Slot.FRICTION_LAW and term.internal:
        full = law.rows(law.at(v=0.7, z=2.0 / term.example[0], level=2.0))
        if not np.allclose(full[:2, VALUE], [2.0, 0.0], atol=1e-12):
            wrong = "at full deflection level/theta[o] the bristle must rest and its force be the level"
    if wrong:
        raise TypeError(f"term {term.key}: {wrong}")


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
        ("v", "side", "z", "level", *_TAIL)
    ),
    Ladder(
        "smoothed_law", "Friction without stick and without a state, and its partials.", "SMOOTHED", SMOOTHED,
        ("v", "a", "level", *_TAIL)
    ),
    Ladder("smooth", "Force on the left side and its partials.", "SMOOTH", SMOOTH, ("x", "v", "t", *_TAIL), "t"),
    Ladder(
        "internal", "Force (row 0), rates of the states, and partials.", "INTERNAL", INTERNAL,
        ("x", "v", "w0", "w1", *_TAIL)
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
        f"from harness.kernels.layout import {', '.join(sorted(ladder.group for ladder in LADDERS))}, laws",
        "",
    ]
    for ladder in LADDERS:
        lines += ladder.lines()
    return "\n".join(lines).rstrip("\n") + "\n"


if __name__ == "__main__":
    from harness.model.registry import TERMS

    for entry in TERMS:
        examine(entry)
    TARGET.write_text(text(), encoding="utf-8")
