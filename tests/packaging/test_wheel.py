"""An installed wheel works from any folder: the models, schemas and vendored files travel inside it."""

import os
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from importlib.metadata import version
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

CHECKOUT = Path(__file__).resolve().parents[2]
MODELS = {"slider.xml", "slider.urdf", "slider_on_floor.xml", "slider_on_floor.urdf"}


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the wheel's content, as an installation has it."""
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "--no-build-isolation", "-w", str(folder)]
    subprocess.run([*build, str(CHECKOUT)], check=True, capture_output=True)
    (wheel,) = folder.glob("*.whl")
    site = folder / "site"
    zipfile.ZipFile(wheel).extractall(site)
    return site


def run(installed: Path, program: str) -> str:
    """Output of a program that finds harness in the wheel, started elsewhere."""
    environment = {**os.environ, "PYTHONPATH": str(installed), "PYTHONDONTWRITEBYTECODE": "1"}
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd="/", env=environment)
    return done.stdout


def test_models_are_found_in_the_wheel(installed: Path) -> None:
    found = run(installed, "from harness.engines import models; print(models.folder())").strip()
    assert Path(found) == installed / "harness" / "_models"
    assert {file.name for file in Path(found).iterdir()} >= MODELS


def test_the_command_and_its_files_are_there(installed: Path) -> None:
    program = "from harness.cli.main import run; import harness; run(['--version']); print(harness.__file__)"
    said = run(installed, program).split("\n")
    assert said[0].startswith("harness, version ")
    assert said[1].startswith(str(installed))
    schemas = {file.name for file in (CHECKOUT / "harness" / "results" / "schemas").glob("*.json")}
    assert {file.name for file in (installed / "harness" / "results" / "schemas").iterdir()} >= schemas
    assert (installed / "harness" / "py.typed").is_file()
    assert (installed / "harness" / "show" / "vendor" / "plotly-cartesian.min.js").is_file()


def test_nothing_but_the_package_is_in_the_wheel(installed: Path) -> None:
    assert {entry.name.split("-")[0] for entry in installed.iterdir()} == {"harness", "friction_harness"}


def test_the_wheel_needs_no_compiler(installed: Path) -> None:
    (wheel,) = installed.parent.glob("*.whl")
    assert wheel.name.endswith("-py3-none-any.whl")


def test_the_sdist_makes_the_same_wheel_and_holds_tests_and_pages(installed: Path, tmp_path: Path) -> None:
    build = [sys.executable, "-m", "hatchling", "build", "-d", str(tmp_path), "-t"]
    subprocess.run([*build, "sdist"], check=True, capture_output=True, cwd=CHECKOUT)
    (packed,) = tmp_path.glob("*.tar.gz")
    with tarfile.open(packed) as archive:
        archive.extractall(tmp_path, filter="data")
    unpacked = tmp_path / packed.name.removesuffix(".tar.gz")
    for name in ("docs/conf.py", "docs/terms/stribeck.svg", "tests/conftest.py", "constraints.txt", ".ci/run"):
        assert (unpacked / name).is_file(), name
    subprocess.run([*build, "wheel"], check=True, capture_output=True, cwd=unpacked)
    (again,), (first,) = tmp_path.glob("*.whl"), installed.parent.glob("*.whl")
    assert sorted(zipfile.ZipFile(again).namelist()) == sorted(zipfile.ZipFile(first).namelist())


def requirements() -> list[Requirement]:
    project = tomllib.loads((CHECKOUT / "pyproject.toml").read_text())["project"]
    extras = [line for lines in project["optional-dependencies"].values() for line in lines]
    return [Requirement(line) for line in [*project["dependencies"], *extras]]


def test_every_dependency_is_locked_to_a_version_it_accepts() -> None:
    lines = [line for line in (CHECKOUT / "constraints.txt").read_text().splitlines() if not line.startswith("#")]
    locked = dict(line.split("==") for line in lines)
    for requirement in requirements():
        if requirement.name == "friction-harness":
            continue  # its own extras, whose packages stand in the list themselves
        assert requirement.specifier.contains(locked[canonicalize_name(requirement.name)]), requirement
    assert not [line for line in lines if "/" in line or "@" in line]


def test_versions_agree() -> None:
    import harness

    project = tomllib.loads((CHECKOUT / "pyproject.toml").read_text())["project"]
    assert project["version"] == harness.__version__ == version("friction-harness")
    assert f"## {harness.__version__}\n" in (CHECKOUT / "CHANGELOG.md").read_text()
