"""What the pages show is what the program does today, links lead somewhere, and the site needs no network."""

import json
import re
import runpy
import subprocess
import sys
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any, get_args

import pytest

from harness.cli.main import run
from harness.model.registry import TERMS
from harness.results.diagnosis import Grade, Verdict

CHECKOUT = Path(__file__).resolve().parents[2]
DOCS = CHECKOUT / "docs"
PAGES = [CHECKOUT / "README.md", CHECKOUT / "CHANGELOG.md", *sorted(DOCS.rglob("*.md"))]
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e-?\d+)?")
RULE = re.compile(r"[─-╿]+| {2,}")
# creep of a slider at rest, and what an estimator reads at a smeared reversal, are small differences of large numbers
LOOSE = 1e-4
PIXELS = 1.0
QUICK = ("quadratic-drag", "sensor-gain")


@pytest.fixture(autouse=True)
def among_docs(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Generators of docs import each other by name."""
    monkeypatch.syspath_prepend(str(DOCS))
    yield
    for name in ("drawing", "signatures"):
        sys.modules.pop(name, None)


def made(script: str) -> dict[str, Any]:
    return runpy.run_path(str(DOCS / script))


def words(text: str) -> list[str]:
    return RULE.sub(" ", NUMBER.sub("#", text)).split()


def alike(new: str, old: str, rel: float, within: float, command: str) -> None:
    """The same words and, to what may differ between machines, the same numbers."""
    assert words(new) == words(old), f"run {command}"
    first, second = ([float(n) for n in NUMBER.findall(text)] for text in (new, old))
    assert first == pytest.approx(second, rel=rel, abs=within), f"run {command}"


def here(call: list[str], cwd: Path, env: dict[str, str], **given: Any) -> "subprocess.CompletedProcess[str]":
    """A command in this process, which has loaded already what it needs; of other programs, a process."""
    if call[1:3] != ["-m", "harness.cli"]:
        with subprocess.Popen(call, cwd=cwd, env=env, stdout=subprocess.PIPE, text=True) as other:
            return subprocess.CompletedProcess(call, 0, other.communicate()[0], "")
    with (
        pytest.MonkeyPatch.context() as patch,
        redirect_stdout(StringIO()) as said,
        redirect_stderr(StringIO()) as wrong,
    ):
        patch.chdir(cwd)
        for name in ("COLUMNS", "NO_COLOR"):
            patch.setenv(name, env[name])
        code = run(call[3:])
        return subprocess.CompletedProcess(call, code, said.getvalue(), wrong.getvalue())


@pytest.mark.slow
@pytest.mark.parametrize(
    "page",
    # commands of the others have tests of their own
    [
        "start.md",
        *(
            pytest.param(f"{n}.md", marks=pytest.mark.full)
            for n in (
                "own-recording",
                "own-simulation",
                "own-scene",
                "robot-example",
                "words",
                "robot-servo",
                "verdicts",
                "own-engine",
                "tune",
            )
        ),
    ],
)
def test_a_page_shows_what_its_commands_print(page: str, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pybullet")
    pytest.importorskip("rosbags")
    monkeypatch.setattr(subprocess, "run", here)
    shown = made("shown.py")
    assert page in shown["PAGES"]
    alike(shown["text"](page), (DOCS / page).read_text(encoding="utf-8"), 0.02, LOOSE, f"python docs/shown.py {page}")


def test_the_page_of_the_notebook_is_made_of_it() -> None:
    cells = json.loads((CHECKOUT / "examples" / "friction.ipynb").read_text(encoding="utf-8"))["cells"]
    text, pictures = made("notebook.py")["page"](cells)
    assert text == (DOCS / "notebook.md").read_text(encoding="utf-8"), "run python docs/notebook.py"
    assert {name: (DOCS / name).read_bytes() for name in pictures} == pictures


@pytest.mark.full
def test_the_notebook_prints_what_it_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(CHECKOUT / "examples")
    script = made("notebook.py")
    cells = json.loads(script["NOTEBOOK"].read_text(encoding="utf-8"))["cells"]
    held = script["page"](cells)[0]
    script["run"](cells)
    alike(script["page"](cells)[0], held, 0.02, LOOSE, "python docs/notebook.py")


def test_the_example_is_what_its_maker_writes() -> None:
    assert (DOCS / "example" / "rig.csv").read_text(encoding="utf-8") == made("example/make.py")["table"]()


def test_the_page_of_results_is_that_of_the_models() -> None:
    assert (DOCS / "results.md").read_text(encoding="utf-8") == made("results_page.py")["text"]()


def test_the_page_of_a_diagnosis_knows_every_verdict_and_grade() -> None:
    page = (DOCS / "reading.md").read_text(encoding="utf-8")
    assert set(re.findall(r"^\| `([\w-]+)` \|", page, re.MULTILINE)) == {"error", *get_args(Verdict), *get_args(Grade)}


def test_the_pages_of_terms_are_those_of_the_registry() -> None:
    folder = DOCS / "terms"
    wanted = made("term_pages.py")["pages"]()
    assert {page: (DOCS / page).read_text(encoding="utf-8") for page in wanted} == wanted, "python docs/term_pages.py"
    assert {f"terms/{file.name}" for file in folder.glob("*.md")} == set(wanted)
    drawn = {term.key for term in TERMS if made("signatures.py")["draws"](term)}
    assert set(json.loads((folder / "signatures.json").read_text(encoding="utf-8"))) == drawn


@pytest.mark.parametrize(
    "key", [t.key if t.key in QUICK else pytest.param(t.key, marks=pytest.mark.full) for t in TERMS]
)
def test_the_picture_of_a_term_is_what_is_left_of_its_motion(key: str) -> None:
    script = made("signatures.py")
    (term,) = (t for t in TERMS if t.key == key)
    if script["draws"](term):
        found = script["signature"](term)
        file = DOCS / "terms" / script["file_name"](term)
        alike(
            script["picture"](found), file.read_text(encoding="utf-8"), 0.0, PIXELS, f"python docs/signatures.py {key}"
        )
        kept = json.loads((DOCS / "terms" / "signatures.json").read_text(encoding="utf-8"))[key]
        assert found.over_noise == pytest.approx(kept["chi2_per_point"], rel=0.02)


def test_the_picture_of_the_concepts_is_drawn_from_the_exact_decay() -> None:
    script = made("pictures.py")
    alike(script["text"](), script["TARGET"].read_text(encoding="utf-8"), 0.0, PIXELS, "python docs/pictures.py")


def broken(page: Path) -> list[str]:
    """Links of a page to files that are not there."""
    text = re.sub(r"```.*?```|`[^`\n]*`", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    links = re.findall(r"\]\((?!https?:)([^)#\s]+)(?:#[^)]*)?\)", text)
    return [link for link in links if not (page.parent / link).exists()]


def test_links_lead_to_files() -> None:
    assert {page: broken(page) for page in PAGES if broken(page)} == {}


@pytest.mark.slow
def test_the_site_is_built_without_a_warning_and_needs_no_network(tmp_path: Path) -> None:
    pytest.importorskip("sphinx")
    build = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-d", str(tmp_path / "trees"), str(DOCS)]
    done = subprocess.run([*build, str(tmp_path / "site")], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    asked = re.compile(r"""(?:src=|<link[^>]+href=|@import |url\()["']?(?:https?:)?//[^"')\s]+""")
    for file in (f for f in (tmp_path / "site").rglob("*") if f.suffix in (".html", ".css")):
        if "_downloads" not in file.parts:
            assert not asked.findall(file.read_text(encoding="utf-8")), file
    pages = {file.relative_to(DOCS).with_suffix(".html") for file in DOCS.rglob("*.md")}
    assert all((tmp_path / "site" / page).is_file() for page in pages)
