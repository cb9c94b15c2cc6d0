"""Numbers that move a verdict stand in one file, with their origin; none is hidden in the code that uses them."""

import ast
from pathlib import Path

import pytest

from harness.diagnosis import rules

ROOT = Path(__file__).resolve().parents[2]
FILES = sorted((ROOT / "harness" / "diagnosis").rglob("*.py"))
GATES = ("verdict.py", "search/search.py", "search/release_transient.py", "residual_tests/structure.py")
"""Files that decide: here no comparison holds a number of its own."""


def _numbers(node: ast.expr) -> set[float]:
    found = (n.value for n in ast.walk(node) if isinstance(n, ast.Constant) and not isinstance(n.value, bool))
    return {abs(float(v)) for v in found if isinstance(v, int | float)}


@pytest.mark.parametrize("name", GATES)
def test_a_gate_compares_with_rules_alone(name: str) -> None:
    tree = ast.parse((ROOT / "harness" / "diagnosis" / name).read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare):
            sides = set().union(*(_numbers(side) for side in (node.left, *node.comparators)))
            assert sides <= {0.0, 1.0, 2.0}, f"{name}:{node.lineno}: {ast.unparse(node)}"
        if isinstance(node, ast.Assign) and name == "verdict.py":
            assert not isinstance(node.value, ast.Constant), f"{name}:{node.lineno}: {ast.unparse(node)}"


def test_every_rule_says_what_it_moves_and_where_it_comes_from() -> None:
    names = [rule.name for rule in rules.RULES]
    assert len(names) == len(set(names)) > 0
    for rule in rules.RULES:
        assert all((rule.moves, rule.origin, rule.unit)), rule.name


@pytest.mark.parametrize("rule", rules.RULES, ids=lambda rule: rule.name)
def test_every_rule_is_used(rule: rules.Rule) -> None:
    constant = next(name for name, value in vars(rules).items() if value is rule)
    used = (n for p in FILES if p.name != "rules.py" for n in ast.walk(ast.parse(p.read_text(encoding="utf-8"))))
    assert any(isinstance(node, ast.Name) and node.id == constant for node in used)


def test_the_page_of_rules_is_made_from_them() -> None:
    assert (ROOT / "docs" / "rules.md").read_text(encoding="utf-8") == rules.document()
