"""Writes a part of docs/architecture.md, the way of a recording and of a slider: python docs/ways.py.

A way is followed from a function of app: what it calls, in the order of the source, as far as app and the pipeline of
the diagnosis go; calls into other packages are its stations.
"""

import ast
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TARGET = ROOT / "docs" / "architecture.md"
BEGIN, END = "<!-- written by python docs/ways.py -->\n", "<!-- end -->"
WAYS = {
    "a recording": ("harness.app.diagnose.many.diagnose",),
    "a slider": (
        "harness.app.run.run.RunOptions.asked",
        "harness.app.run.case.SuiteCase.exact",
        "harness.app.run.case.SuiteCase.simulated",
        "harness.app.run.case.SuiteCase.metrics",
        "harness.app.run.case.SuiteCase.estimated",
        "harness.app.run.run.measured",
        "harness.app.run.run.run",
    ),
}
"""Where each way begins; a slider's goes through what a case does, which no call names."""
FOLLOWED = ("harness.app", "harness.diagnosis.pipeline", "harness.diagnosis.kinds")
KINDS, KIND = ("kind_for", "kind_of"), "harness.diagnosis.kinds.free_decay.FreeDecays"
"""Where the kind of a recording says what is called, the way is that of this one."""
LEFT_OUT = ("harness.core", "harness.results")
MOST = 6
"""Functions named at one station."""


@dataclass
class Module:
    """Functions by name ("function" or "Class.method"), and what the names in it stand for."""

    functions: dict[str, ast.FunctionDef] = field(default_factory=dict)
    stands_for: dict[str, str] = field(default_factory=dict)


@cache
def module(name: str) -> Module | None:
    """A module of ours; None for what is none."""
    file = ROOT.joinpath(*name.split(".")).with_suffix(".py")
    if not file.is_file():
        return None
    found = Module()
    tree = ast.parse(file.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("harness"):
            found.stands_for |= {alias.asname or alias.name: f"{node.module}.{alias.name}" for alias in node.names}
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            found.functions[node.name] = node
        elif isinstance(node, ast.ClassDef):
            found.functions |= {f"{node.name}.{n.name}": n for n in node.body if isinstance(n, ast.FunctionDef)}
    found.stands_for |= {name_: f"{name}.{name_}" for name_ in found.functions}
    return found


def split(path: str) -> tuple[str, str]:
    """The module and the function of a dotted path."""
    parts = path.split(".")
    for end in range(len(parts) - 1, 0, -1):
        if module(".".join(parts[:end])) is not None:
            return ".".join(parts[:end]), ".".join(parts[end:])
    return path.rpartition(".")[0], path.rpartition(".")[2]


def _in_order(body: Sequence[ast.stmt]) -> list[ast.Call]:
    """Calls in the order of the source; a branch that ends in a return is another way, and comes last."""
    straight, aside = [], []
    for statement in body:
        leaves = isinstance(statement, ast.If) and isinstance(statement.body[-1], ast.Return)
        (aside if leaves else straight).append(statement)
    found: list[ast.Call] = []
    for statement in (*straight, *aside):
        lambdas = {inner for node in ast.walk(statement) if isinstance(node, ast.Lambda) for inner in ast.walk(node)}
        calls = [node for node in ast.walk(statement) if isinstance(node, ast.Call) and node not in lambdas]
        found += sorted(calls, key=lambda node: (node.end_lineno or 0, node.end_col_offset or 0))
    return found


def called(path: str) -> Iterator[str]:
    """What a function calls, in the order of the source."""
    place, name = split(path)
    home = module(place)
    if home is None or name not in home.functions:
        return
    function = home.functions[name]
    typed = {a.arg: a.annotation.id for a in function.args.args if isinstance(a.annotation, ast.Name)}
    for call in _in_order(function.body):
        match call.func:
            case ast.Name(id=known) if known in home.stands_for:
                yield home.stands_for[known]
            case ast.Attribute(value=ast.Call(func=ast.Name(id=known)), attr=attr) if known in KINDS:
                yield f"{KIND}.{attr}"
            case ast.Attribute(value=ast.Name(id=known), attr=attr) if typed.get(known, known) in home.stands_for:
                target = home.stands_for[typed.get(known, known)]
                # a function of a module, or a method of an argument; how a class makes itself is no station
                if known in typed or module(target) is not None:
                    yield f"{target}.{attr}"


def stations(path: str, seen: set[str]) -> Iterator[tuple[str, str]]:
    """Package and function of every station of a way, each once."""
    for target in called(path):
        if target in seen:
            continue
        seen.add(target)
        place, name = split(target)
        if place.startswith(LEFT_OUT):
            continue
        if place.startswith(FOLLOWED):
            yield from stations(target, seen)
        elif name.rpartition(".")[2][:1].islower():
            yield package(place), name.rpartition(".")[2]


def package(place: str) -> str:
    """The folder of a module without the name of the whole."""
    folder = place if ROOT.joinpath(*place.split("."), "__init__.py").is_file() else place.rpartition(".")[0]
    return folder.removeprefix("harness.")


def lists() -> str:
    """Both ways as lists: a station for each package, where the way first comes to it."""
    lines: list[str] = []
    for what, begins in WAYS.items():
        passed: dict[str, list[str]] = {}
        seen: set[str] = set()
        for begin in begins:
            for where, name in stations(begin, seen):
                passed.setdefault(where, []).append(name)
        lines += [f"### The way of {what}", ""]
        for place, (where, names) in enumerate(passed.items(), start=1):
            said = [f"`{name}`" for name in dict.fromkeys(names[:MOST])] + ["..."] * (len(names) > MOST)
            lines.append(f"{place}. **{where}**: {', '.join(said)}")
        lines.append("")
    return "\n".join(lines)


def text() -> str:
    """docs/architecture.md with the ways as the code has it now."""
    page = TARGET.read_text(encoding="utf-8")
    return re.sub(re.escape(BEGIN) + ".*?" + re.escape(END), lambda _: BEGIN + lists() + END, page, flags=re.DOTALL)


if __name__ == "__main__":
    TARGET.write_text(text(), encoding="utf-8")
