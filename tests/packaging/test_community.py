"""What stands beside the code agrees with it: citation, workflow, contributing, hooks."""

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

CHECKOUT = Path(__file__).resolve().parents[2]
GITHUB = CHECKOUT / ".github"
YAML = [CHECKOUT / "CITATION.cff", CHECKOUT / ".pre-commit-config.yaml", *sorted(GITHUB.rglob("*.yml"))]


@pytest.mark.parametrize("path", YAML, ids=lambda path: path.name)
def test_it_is_yaml(path: Path) -> None:
    yaml = pytest.importorskip("yaml")
    assert isinstance(yaml.safe_load(path.read_text(encoding="utf-8")), dict)


def test_the_citation_is_of_this_version() -> None:
    project: dict[str, Any] = tomllib.loads((CHECKOUT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    lines = (CHECKOUT / "CITATION.cff").read_text(encoding="utf-8").splitlines()
    assert f"title: {project['name']}" in lines
    assert f"version: {project['version']}" in lines
    assert f"license: {project['license']}" in lines


def test_the_workflow_runs_what_anybody_can_run() -> None:
    text = (GITHUB / "workflows" / "ci.yml").read_text(encoding="utf-8")
    assert re.findall(r"run: (\S.*)", text) == ["./.ci/run"]
    assert (CHECKOUT / ".ci" / "run").stat().st_mode & 0o111


def test_links_and_commands_of_contributing_are_those_of_the_project() -> None:
    text = (GITHUB / "CONTRIBUTING.md").read_text(encoding="utf-8")
    for link in re.findall(r"\]\((?!https?:)([^)]+)\)", text):
        assert (GITHUB / link).resolve().is_file(), link
    (line,) = re.findall(r"^python3 -m venv.*$", text, re.MULTILINE)
    assert line in (CHECKOUT / "README.md").read_text(encoding="utf-8").splitlines()
