"""What stands beside the code agrees with it: README, citation, workflow, contributing, hooks."""

import re
import shlex
import tomllib
from pathlib import Path
from runpy import run_path
from typing import Any

import click
import pytest

from harness.cli.main import cli

CHECKOUT = Path(__file__).resolve().parents[2]
README = (CHECKOUT / "README.md").read_text(encoding="utf-8")
LINES = [line for block in re.findall(r"```sh\n(.*?)```", README, re.DOTALL) for line in block.splitlines()]
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


def test_items_of_a_release_stand_first_under_its_version(tmp_path: Path) -> None:
    collected = run_path(str(CHECKOUT / "changes" / "collect.py"))["collected"]
    log = "# Changelog\n\n## 0.1.0\n\n- old\n"
    assert collected(log, "0.1.0", ["- new\n"]) == "# Changelog\n\n## 0.1.0\n\n- new\n- old\n"
    assert collected(log, "0.2.0", ["- new"]) == "# Changelog\n\n## 0.2.0\n\n- new\n\n## 0.1.0\n\n- old\n"


def test_every_change_is_one_item() -> None:
    for file in (CHECKOUT / "changes").glob("*.md"):
        text = file.read_text(encoding="utf-8")
        assert file.name == "README.md" or re.fullmatch(r"- .+(\n  .+)*\n?", text), file.name


def test_links_and_commands_of_contributing_are_those_of_the_project() -> None:
    text = (GITHUB / "CONTRIBUTING.md").read_text(encoding="utf-8")
    for link in re.findall(r"\]\((?!https?:)([^)]+)\)", text):
        assert (GITHUB / link).resolve().is_file(), link
    (line,) = re.findall(r"^python3 -m venv.*$", text, re.MULTILINE)
    assert line in README.splitlines()


def test_two_lines_make_an_environment_each() -> None:
    first, second = [line for line in LINES if line.startswith("python3 -m venv")]
    assert first.endswith(".venv/bin/harness run")
    assert ".[test]" in second
    assert "-m pytest" in second
    assert all("-c constraints.txt" in line for line in (first, second))


@pytest.mark.parametrize("line", [line for line in LINES if line.startswith("harness ")])
def test_every_command_shown_can_be_parsed(line: str) -> None:
    _, name, *args = shlex.split(line)
    context = click.Context(cli)
    command = cli.get_command(context, name)
    assert command is not None
    command.make_context(name, args)


def test_files_it_points_to_are_there() -> None:
    links = re.findall(r"\]\((?!https?:)([^)]+)\)", README)
    assert links
    for link in links:
        assert (CHECKOUT / link).is_file(), link
    for named in re.findall(r"harness/[\w/]+(?:\.py)?", README):
        assert (CHECKOUT / named).exists(), named
