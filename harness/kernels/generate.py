"""Writes harness/kernels/dispatch.py from the registry: ``python -m harness.kernels.generate``."""

from pathlib import Path

from harness.kernels.layout import INTERNAL, MODULATIONS, SMOOTH
from harness.model.term import Term

_WIDTH = 120
TARGET = Path(__file__).with_name("dispatch.py")
_SMOOTH_ARGS = "x, v, t, theta, o, out"
_INTERNAL_ARGS = "x, v, w0, w1, theta, o, out"
_SIGNATURES = {
    _SMOOTH_ARGS: "number: int, x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray",
    _INTERNAL_ARGS: "number: int, x: float, v: float, w0: float, w1: float, theta: FloatArray, o: int, out: FloatArray",
}


def _alias(term: Term) -> str:
    return "_" + term.key.replace("-", "_").replace(":", "_")


def _ladder(name: str, doc: str, terms: tuple[Term, ...], arguments: str) -> list[str]:
    head = f"def _{name}({_SIGNATURES[arguments]}) -> None:"
    wrapped = [f"def _{name}(", f"    {_SIGNATURES[arguments]}", ") -> None:"]
    lines = [*([head] if len(head) <= _WIDTH else wrapped), f'    """{doc}"""']
    for number, term in enumerate(terms):
        word = "if" if number == 0 else "elif"
        lines += [f"    {word} number == {number}:", f"        {_alias(term)}({arguments})"]
    return [*lines, "", "", f"{name} = compiled(_{name}, lean=True)", "", ""]


def text() -> str:
    """The dispatch file as it follows from the registry."""
    groups = (MODULATIONS, SMOOTH, INTERNAL)
    modules = sorted({t.law.__module__.rsplit(".", 1)[1] for group in groups for t in group if t.law is not None})
    lines = [
        '"""Dispatch of laws by number; generated from the registry by harness.kernels.generate, do not edit."""',
        "",
        "from harness.core.arrays import FloatArray",
        "from harness.core.jit import compiled",
        "from harness.model.terms import (",
        *[f"    {module}," for module in modules],
        ")",
        "",
    ]
    for group in groups:
        for term in group:
            if term.law is None:
                raise TypeError(f"{term.key} has no law")
            module = term.law.__module__.rsplit(".", 1)[1]
            lines.append(f"{_alias(term)} = compiled({module}.{term.law.__name__}, lean=True)")
    lines += ["", ""]
    lines += _ladder("modulation", "Factor on f_k and its partials.", MODULATIONS, _SMOOTH_ARGS)
    lines += _ladder("smooth", "Force on the left side and its partials.", SMOOTH, _SMOOTH_ARGS)
    lines += _ladder("internal", "Force (row 0), rates of the states, and partials.", INTERNAL, _INTERNAL_ARGS)
    return "\n".join(lines).rstrip("\n") + "\n"


if __name__ == "__main__":
    TARGET.write_text(text())
