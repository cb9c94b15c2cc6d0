"""Mutation testing of what decides: ``python -m benchmarks.mutation --sample 500``.

Each mutant changes one operator, comparison, condition or number of one file and runs the tests of that file in a
process of its own; it is killed when one fails, and survives when none does. The file itself is left alone: the change
is made while it is imported. Functions of the file that is changed are not compiled, so that what is tested is what is
written; all others are. Exit 1 when more than a tenth of the sample survive.
"""

import argparse
import ast
import importlib
import multiprocessing
import os
import random
import signal
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, partial
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from pathlib import Path
from typing import Any

from benchmarks.plain import plain

ROOT = Path(__file__).resolve().parents[1]


def _tests(of: str, *names: str) -> tuple[str, ...]:
    return tuple(f"tests/{of}/test_{name}.py" for name in names)


HELD = _tests("estimate", "figures")
ESTIMATE = _tests("estimate", "estimators", "noise", "acceleration_estimator", "smeared_jumps", "paper")
RULES = _tests("diagnosis", "rules", "two_laws")
DECIDED = _tests("diagnosis", "grading")
DECIDE = ("verdict", "grading/grade", "grading/misfit", "grading/first_turn", "grading/friction_split")
TARGETS = {
    **{
        f"harness/estimate/{file.name}": (HELD, ESTIMATE)
        for file in sorted((ROOT / "harness" / "estimate").glob("*.py"))
    },
    "harness/estimate/saturation.py": (HELD, _tests("estimate", "saturation")),
    "harness/diagnosis/rules.py": (_tests("diagnosis", "rules"), DECIDED),
    **{f"harness/diagnosis/{name}.py": (DECIDED, RULES) for name in DECIDE},
}
"""What is changed, and the tests that must notice: those that see nearly all, and quickly, and all others."""
LOADED_BEFORE = ("scipy.optimize", "scipy.linalg", "scipy.signal", "harness.exact", "harness.kernels.solve")
"""Imported once, before the processes part; none of it imports what is changed."""
TOO_LONG = "anything_gets"
"""Takes two minutes where a kernel is not compiled."""
LAST = "refused_with_the_reason or table_1 or cramer_rao or coloured_noise"
"""Tests that take long: only what survives the others is run through them."""
MOST_SURVIVORS = 0.1
SURVIVED, NO_TEST = "SURVIVED", 5
PATIENCE, SETTLED = 2.0, 5.0
"""Times what the tests take without a change, and s besides, after which a mutant counts as killed: it does not end."""

SWAPS: dict[type[ast.AST], type[ast.AST]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.And: ast.Or,
    ast.Or: ast.And,
}


@dataclass(frozen=True, slots=True)
class Mutant:
    """The change at one place of a file, counted from its beginning."""

    file: str
    place: int
    line: int
    what: str

    @property
    def told(self) -> str:
        """File, line and change."""
        return f"{self.file}:{self.line}: {self.what}"


class Changer(ast.NodeVisitor):
    """Goes through a file and changes the place of that number; -1 only lists them."""

    def __init__(self, file: str, place: int = -1) -> None:
        self.file, self.place, self.found = file, place, list[Mutant]()

    def visit(self, node: ast.AST) -> None:
        """Types and texts are no behaviour: annotations are left out, and strings are no place."""
        if isinstance(node, ast.AnnAssign):
            self._fields(node, {"annotation"})
        elif isinstance(node, ast.FunctionDef | ast.ClassDef):
            self._fields(node, {"returns", "decorator_list"})
        elif not isinstance(node, ast.arg | ast.JoinedStr):
            self._fields(node, set())

    def _fields(self, node: ast.AST, left_out: set[str]) -> None:
        for name, value in ast.iter_fields(node):
            if name in left_out:
                continue
            for i, inner in enumerate(value if isinstance(value, list) else [value]):
                if isinstance(inner, ast.AST):
                    self._at(node, name, i if isinstance(value, list) else None, inner)
                    self.visit(inner)

    def _at(self, node: ast.AST, name: str, index: int | None, inner: ast.AST) -> None:
        changed = _changed(node, name, inner)
        if changed is None:
            return
        line = getattr(inner, "lineno", getattr(node, "lineno", 0))
        before = ast.unparse(node if isinstance(inner, ast.operator | ast.cmpop | ast.boolop) else inner)
        here = len(self.found) == self.place
        if here and index is None:
            setattr(node, name, changed)
        elif here:
            getattr(node, name)[index] = changed
        after = type(changed).__name__ if changed.__class__ in SWAPS else ast.unparse(changed)
        self.found.append(Mutant(self.file, len(self.found), line, f"{before}  ->  {after}"))


def _changed(node: ast.AST, name: str, inner: ast.AST) -> ast.AST | None:
    """What stands in the place of ``inner``; None where nothing does."""
    if type(inner) in SWAPS and not (isinstance(node, ast.BinOp) and _typed(node)):
        return SWAPS[type(inner)]()
    if isinstance(node, ast.If | ast.IfExp | ast.While) and name == "test" and isinstance(inner, ast.Name | ast.Call):
        return ast.UnaryOp(ast.Not(), inner)
    if isinstance(inner, ast.UnaryOp) and isinstance(inner.op, ast.USub):
        return inner.operand
    if isinstance(inner, ast.Constant) and type(inner.value) is bool:
        return ast.Constant(not inner.value)
    if isinstance(inner, ast.Constant) and isinstance(inner.value, int | float):
        return ast.Constant(inner.value + 1 if isinstance(inner.value, int) else 2.0 * inner.value or 1.0)
    return None


def _typed(node: ast.BinOp) -> bool:
    """Whether it joins texts."""
    return any(
        isinstance(side, ast.JoinedStr) or (isinstance(side, ast.Constant) and isinstance(side.value, str))
        for side in (node.left, node.right)
    )


def places(file: str) -> list[Mutant]:
    """Every mutant of a file."""
    changer = Changer(file)
    changer.visit(ast.parse((ROOT / file).read_text(encoding="utf-8")))
    return changer.found


class Changed(SourceFileLoader):
    """Loads a module with one change."""

    mutant: Mutant

    def get_code(self, fullname: str) -> Any:
        """Compiled from the changed source; never from a file of bytecode."""
        tree = ast.parse(Path(self.path).read_text(encoding="utf-8"))
        Changer(self.mutant.file, self.mutant.place).visit(tree)
        return compile(ast.fix_missing_locations(tree), self.path, "exec")


class Finder(PathFinder):
    """Finds the one module that is changed."""

    mutant: Mutant | None = None

    @classmethod
    def find_spec(cls, fullname: str, path: Sequence[str] | None = None, target: Any = None) -> ModuleSpec | None:
        """See importlib."""
        if cls.mutant is None or fullname != cls.mutant.file.removesuffix(".py").replace("/", "."):
            return None
        spec = super().find_spec(fullname, path, target)
        assert spec is not None
        assert spec.origin is not None
        spec.loader = Changed(fullname, spec.origin)
        spec.loader.mutant = cls.mutant
        return spec


def tested(mutant: Mutant, plain: str, quick: bool) -> str:
    """What becomes of a mutant: killed, without an end, or survived; plain : see ``limit_of``."""
    first, others = TARGETS[mutant.file]
    later: list[Sequence[str]] = [(*others, "-k", f"not ({LAST} or {TOO_LONG})"), (*others, "-k", LAST)]
    for tests in (first, *([] if quick else later)):
        found = _in_a_process(mutant.file, mutant, tests, limit_of(tests, plain))
        if found != SURVIVED:
            return found
    return SURVIVED


def _in_a_process(file: str, mutant: Mutant | None, tests: Sequence[str], limit: float) -> str:
    child = os.fork()
    if child == 0:
        import pytest

        nothing = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, 1)
        os.dup2(nothing, 2)
        signal.alarm(int(limit) + 1)
        Finder.mutant = mutant
        sys.meta_path.insert(0, Finder)
        plain(file.removesuffix(".py").replace("/", "."))
        os._exit(int(pytest.main(["-q", "-x", "-n", "0", "-p", "no:cacheprovider", *tests])))
    status = os.waitpid(child, 0)[1]
    if os.WIFSIGNALED(status):
        return "killed, no end"
    return SURVIVED if os.WEXITSTATUS(status) in (0, NO_TEST) else "killed"


@cache
def limit_of(tests: Sequence[str], plain: str) -> float:
    """How long tests may take, s, with the functions of one file not compiled; they must pass without a change."""
    began = time.monotonic()
    if _in_a_process(plain, None, tests, PATIENCE * 3600.0) != SURVIVED:
        raise SystemExit(f"{' '.join(tests)}: they fail without a change to {plain}")
    return PATIENCE * (time.monotonic() - began) + SETTLED


def sample(count: int, seed: int, only: str) -> list[Mutant]:
    """So many of all places, the same ones for the same seed."""
    every = [mutant for file in TARGETS if only in file for mutant in places(file)]
    return random.Random(seed).sample(every, min(count, len(every)))


def survivors_of(log: Path, chosen: Sequence[Mutant]) -> list[Mutant]:
    """Those of a sample that survived in an earlier run, by the lines it printed."""
    lines = {line.partition(f" {SURVIVED}: ")[2] for line in log.read_text(encoding="utf-8").splitlines()}
    return [mutant for mutant in chosen if mutant.told in lines]


def outcome(mutant: Mutant, quick: bool) -> str:
    """What becomes of a mutant by the tests of its file."""
    has_compiled = "harness.core.jit" in (ROOT / mutant.file).read_text(encoding="utf-8")
    return tested(mutant, mutant.file if has_compiled else "none.py", quick)


def main() -> int:
    """See the module."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.mutation", description=__doc__)
    parser.add_argument("--sample", type=int, default=500, help="how many mutants; 500")
    parser.add_argument("--seed", type=int, default=1, help="which ones; 1")
    parser.add_argument("--only", default="", help="part of the name of the files that are changed")
    parser.add_argument("--quick", action="store_true", help="the quick tests alone: more survive")
    parser.add_argument("--survivors", type=Path, metavar="LOG", help="of an earlier run's output: those alone")
    parser.add_argument("--jobs", type=int, default=2, help="processes at a time; 2")
    given = parser.parse_args()
    os.chdir(ROOT)
    for name in LOADED_BEFORE:
        importlib.import_module(name)
    chosen = sample(given.sample, given.seed, given.only)
    every = len(chosen)
    chosen = survivors_of(given.survivors, chosen) if given.survivors else chosen
    survivors, of = 0, len(chosen)
    with multiprocessing.get_context("fork").Pool(given.jobs) as workers:
        ends = workers.imap(partial(outcome, quick=given.quick), chosen)
        for i, (mutant, found) in enumerate(zip(chosen, ends, strict=True), start=1):
            survivors += found == SURVIVED
            print(f"{i}/{of} {found}: {mutant.told}", flush=True)
    print(f"{survivors} of {every} mutants survived")
    return int(survivors > MOST_SURVIVORS * every)


if __name__ == "__main__":
    raise SystemExit(main())
