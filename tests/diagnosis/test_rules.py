"""Numbers that move a verdict stand in one file, with their origin; none is hidden in the code that uses them."""

import ast
import functools
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

from harness.diagnosis import rules
from harness.robot.whole_arm import rules as arm_rules

ROOT = Path(__file__).resolve().parents[2]
FILES = sorted((ROOT / "harness" / "diagnosis").rglob("*.py"))
ARM = sorted((ROOT / "harness" / "robot" / "whole_arm").rglob("*.py"))
LOGS = [ROOT / "harness" / "io" / "logs" / "suspicions.py"]
GATES = ("verdict.py", "search/search.py", "search/release_transient.py", "residual_tests/structure.py")
"""Files that decide and nothing else: they hold no constant of their own."""
PLAIN = frozenset({0.0, 1.0, 2.0})
"""Numbers that are no threshold: nothing, a whole, a pair."""
HALF = 0.5
"""Of a width, say: borne as a factor, not as what is compared with."""
ROUNDING = 1e-12
"""What only keeps a division from 0."""


def _numbers(node: ast.expr) -> set[float]:
    found = (n.value for n in ast.walk(node) if isinstance(n, ast.Constant) and not isinstance(n.value, bool))
    return {abs(float(v)) for v in found if isinstance(v, int | float)}


def _bare(node: ast.expr) -> set[float]:
    """Numbers of one side of a comparison that are thresholds; places in a sequence are none."""
    inner = [n for n in ast.walk(node) if isinstance(n, ast.Subscript)]
    places = set().union(*(_numbers(n.slice) for n in inner)) if inner else set()
    alone = isinstance(node, ast.Constant)
    return {n for n in _numbers(node) - places - PLAIN if n > ROUNDING and (alone or n != HALF)}


def _thresholds(tree: ast.Module) -> list[tuple[int, str]]:
    """Comparisons with a number that has no name, with their lines."""
    compared = (n for n in ast.walk(tree) if isinstance(n, ast.Compare))
    return [(n.lineno, ast.unparse(n)) for n in compared if any(map(_bare, (n.left, *n.comparators)))]


def _wordless(tree: ast.Module) -> list[tuple[int, str]]:
    """Constants of a module that hold numbers and that no sentence follows; one may speak of several in a row."""
    found: list[tuple[int, str]] = []
    waiting: list[tuple[int, str]] = []
    for node in tree.body:
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None and _is_number(node.value):
            waiting.append((node.lineno, ast.unparse(node)))
            continue
        said = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
        found += [] if said else waiting
        waiting = []
    return found + waiting


def _is_number(value: ast.expr) -> bool:
    """Whether a value is a number, or several."""
    simple = (ast.Constant, ast.Tuple, ast.UnaryOp, ast.BinOp, ast.operator, ast.unaryop, ast.Load)
    return all(isinstance(n, simple) for n in ast.walk(value)) and bool(_numbers(value))


@functools.cache
def _tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def test_a_bare_number_is_seen() -> None:
    bad = "a > 0.95 * b or p < 0.05\nabs(x - y) > 3.0 * s\nn < 3\na[7] > 1.0 or r <= 0.5 * w"
    assert sorted(line for line, _ in _thresholds(ast.parse(bad))) == [1, 1, 2, 3]
    constants = 'A = 3\nB, C = 1.0, 2.0\n"""What they are."""\nD = 0.1\nE = "text"\nF = f(3)'
    assert _wordless(ast.parse(constants)) == [(4, "D = 0.1")]


@pytest.mark.parametrize("hidden", [_thresholds, _wordless], ids=["compared with", "without a sentence"])
def test_no_number_that_decides_stands_without_a_name_and_a_sentence(
    hidden: Callable[[ast.Module], list[tuple[int, str]]],
) -> None:
    files = [*FILES, *ARM, *LOGS]
    assert [f"{p.relative_to(ROOT)}:{line}: {text}" for p in files for line, text in hidden(_tree(p))] == []


def test_what_decides_holds_no_number_of_its_own() -> None:
    # how much is searched, when turns end, how fine a curve is
    allowed = {"_BEAM", "_FEWEST_STARTS", "_FREED", "_PAIRED", "_NOISE_MOVED", "_SAME", "_WAVES"}
    for name in GATES:
        for node in _tree(ROOT / "harness" / "diagnosis" / name).body:
            if isinstance(node, ast.Assign) and _is_number(node.value):
                names = {n.id for target in node.targets for n in ast.walk(target) if isinstance(n, ast.Name)}
                assert names <= allowed, f"{name}:{node.lineno}: {ast.unparse(node)}"


@pytest.mark.parametrize("room", [rules, arm_rules], ids=["diagnosis", "whole arm"])
def test_every_rule_says_what_it_moves_and_where_it_comes_from(room: ModuleType) -> None:
    names = [rule.name for rule in room.RULES]
    assert len(names) == len(set(names)) > 0
    for rule in room.RULES:
        assert all((rule.moves, rule.unit, len(rule.origin) > 10)), rule.name
        assert not any(word in f"{rule.moves} {rule.origin}" for word in ("TODO", "XXX", "FIXME")), rule.name


def _used(names: set[str], files: list[Path]) -> set[str]:
    """Those of the names that code stands on, in files that have any of them."""
    some = [p for p in files if p.name != "rules.py" and any(name in p.read_text(encoding="utf-8") for name in names)]
    return {n.id for p in some for n in ast.walk(_tree(p)) if isinstance(n, ast.Name)} & names


@pytest.mark.parametrize(
    ("room", "files"),
    [(rules, sorted((ROOT / "harness").rglob("*.py"))), (arm_rules, ARM)],
    ids=["diagnosis", "whole arm"],
)
def test_every_rule_is_used(room: ModuleType, files: list[Path]) -> None:
    named = {name for name, value in vars(room).items() if value in room.RULES}
    assert len(named) == len(room.RULES) > 0
    assert named - _used(named, files) == set()


def test_the_page_of_rules_is_made_from_them() -> None:
    assert (ROOT / "docs" / "rules.md").read_text(encoding="utf-8") == rules.document()
