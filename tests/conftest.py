"""Shared fixtures: the long forms stay out of the default run, recordings are found where they are."""

import gc
import os
import shutil
import sys
from collections.abc import Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

# a worker has one core: threads of its linear algebra, and its own, would only wait for each other
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
if "PYTEST_XDIST_WORKER" in os.environ:
    os.environ.setdefault("HARNESS_THREADS", "1")

import pytest
from hypothesis import settings
from xdist.remote import Producer
from xdist.scheduler import LoadScopeScheduling

from harness.core.apart import read_apart
from harness.engines.registry import NO_PYBULLET

# what is imported for the tests stays: it is looked through once, and not again whenever something may be left over
gc.disable()
settings.register_profile("stable", derandomize=True, deadline=None, max_examples=60, print_blob=False)
settings.load_profile("stable")

if TYPE_CHECKING:
    from playwright.sync_api import Browser

# what reads a file apart reads the next one too, as it does for a folder of them: each start loads a library anew
assert read_apart.__kwdefaults__ is not None
read_apart.__kwdefaults__["kept"] = True

CHECKOUT = Path(__file__).resolve().parents[1]


@cache
def _no_pybullet() -> bool:
    """Whether there is no wheel of PyBullet for this Python: where there is one, its absence is a failure."""
    return sys.version_info >= NO_PYBULLET and find_spec("pybullet") is None


@pytest.fixture(scope="session")
def pybullet() -> None:
    """What asks for it needs PyBullet."""
    if _no_pybullet():
        pytest.skip("PyBullet has no wheel for this Python")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out the long forms unless -m asks for them, and cases of PyBullet where it cannot be had."""
    if _no_pybullet():
        for item in items:
            if "pybullet" in item.name:
                item.add_marker(pytest.mark.skip(reason="PyBullet has no wheel for this Python"))
    if "full" in str(config.getoption("-m")):
        return
    config.hook.pytest_deselected(items=[item for item in items if item.get_closest_marker("full")])
    items[:] = [item for item in items if not item.get_closest_marker("full")]


def pytest_collection_finish() -> None:
    """See the beginning."""
    gc.freeze()
    gc.enable()


class BesideShared(LoadScopeScheduling):  # type: ignore[misc, unused-ignore]
    """Tests go to processes one by one, but those of a file in which something is made once for all go together."""

    def _split_scope(self, nodeid: str) -> str:
        file = nodeid.split("::", maxsplit=1)[0]
        return file if _shares(CHECKOUT / file) else nodeid


@cache
def _shares(file: Path) -> bool:
    text = file.read_text(encoding="utf-8")
    return 'scope="module"' in text or "cache" in text


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> BesideShared:
    """See the class."""
    return BesideShared(config, log)


@pytest.fixture(scope="module")
def browser() -> Iterator["Browser"]:
    """Chromium without a screen, where it is installed; its event loop is not there for the tests of other files."""
    chromium = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if chromium is None:
        pytest.skip("no Chromium on this machine (apt-get install chromium)")
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    flags = "headless no-sandbox disable-gpu disable-quic no-first-run disable-background-networking"
    flags += " disable-component-update disable-sync"
    with playwright.sync_playwright() as driver:
        found = driver.chromium.launch(executable_path=chromium, args=[f"--{flag}" for flag in flags.split()])
        yield found
        found.close()


@pytest.fixture(scope="session")
def recordings() -> Path:
    """The folder of measured recordings, which are not part of the project."""
    for folder in (os.environ.get("HARNESS_RECORDINGS", ""), str(CHECKOUT.parent / "shared" / "recordings")):
        if folder and Path(folder).is_dir():
            return Path(folder)
    pytest.skip("no measured recordings here (set HARNESS_RECORDINGS)")
