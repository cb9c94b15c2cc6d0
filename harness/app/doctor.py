"""What works on this machine and what does not: harness doctor."""

import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

from harness.app.shared.machine import package_version, this_machine
from harness.app.shared.progress import journal
from harness.results.common import Check, DoctorResult

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "firefox")
ALWAYS = ("python", "engine mujoco", "models", "numba cache", "rerun viewer")
"""Checks that must pass; the others are optional, and so are engines that this Python cannot have."""
_EXTRAS = {
    "distributed": ("sweeps on a cluster", "cluster"),
    "rosbags": ("robot logs in ROS bags", "bags"),
    "openpyxl": ("recordings in Excel files", "files"),
    "nptdms": ("recordings in .tdms files", "files"),
}
_ELSEWHERE = "python3.11 -m venv ENV; ENV/bin/pip install {0} scipy numba platformdirs; --engine {1}@ENV/bin/python"
_REMEDY = {name: f"pip install 'friction-harness[{name}]'" for name in ("dart", "rapier", "drake", "mjx", "warp")} | {
    "physx": _ELSEWHERE.format("ovphysx physx-usd-schemas newton-usd-schemas", "physx") + " (NVIDIA's licence)",
    "newton": _ELSEWHERE.format("'newton[sim]'", "newton"),
}
"""physx can also be had here as an extra; newton asks for another mujoco than ours."""
_ENV = {"PATH": "/usr/bin:/bin", "RERUN_ANALYTICS": "0"}


def doctor() -> DoctorResult:
    """Look at the installation; nothing is changed and nothing is raised for what is missing."""
    with tempfile.TemporaryDirectory() as folder, journal(Path(folder) / "log.txt"):
        checks = [_python(), *_engines(), _models(), _numba_cache(), _viewer(), *_beside()]
    return DoctorResult(checks=checks, machine=this_machine())


def healthy(result: DoctorResult) -> bool:
    """Whether everything works that the main job needs."""
    return all(check.ok for check in result.checks if check.name in _required())


def _required() -> tuple[str, ...]:
    from harness.engines import registry

    return (*ALWAYS, *(f"engine {name}" for name in registry.usual()))


def _python() -> Check:
    version = sys.version.split()[0]
    remedy = None if sys.version_info >= (3, 11) else "use Python 3.11 or later"
    return Check(name="python", ok=remedy is None, found=version, needed_for="everything", remedy=remedy)


def _engines() -> list[Check]:
    from harness.engines import registry

    required, checks = _required(), []
    for name in registry.names():
        needed = f"simulations in {name}" + ("" if f"engine {name}" in required else " (optional)")
        remedy = _REMEDY.get(name, f"pip install {name}")
        if name == "pybullet" and sys.version_info >= registry.NO_PYBULLET:
            remedy = f"no wheel above Python 3.11; {_ELSEWHERE.format('pybullet', 'pybullet')}"
        found = partial(lambda one: f"version {registry.load(one).version()}", name)
        checks.append(_tried(f"engine {name}", needed, remedy, found))
    return checks


def _tried(name: str, needed_for: str, remedy: str, find: Callable[[], str]) -> Check:
    """A check that passes unless ``find`` raises."""
    try:
        return Check(name=name, ok=True, found=find(), needed_for=needed_for)
    except Exception as error:  # whatever a broken installation raises is what the doctor is to report
        found = f"{type(error).__name__}: {error}"
        return Check(name=name, ok=False, found=found, needed_for=needed_for, remedy=remedy)


def _models() -> Check:
    from harness.engines import models

    return _tried("models", "every simulation", "install the package again", lambda: str(models.folder()))


def _numba_cache() -> Check:
    def find() -> str:
        from harness.core.kernel_cache import cache_folder

        folder = cache_folder()
        kernels = sum(1 for _ in folder.rglob("*.nbc"))
        return f"{folder} ({kernels} compiled kernels)"

    return _tried("numba cache", "a quick start", "set NUMBA_CACHE_DIR to a folder that you alone can write to", find)


def _viewer() -> Check:
    def find() -> str:
        program = shutil.which("rerun", path=str(Path(sys.executable).parent)) or shutil.which("rerun")
        if program is None:
            raise FileNotFoundError("the program rerun is not on the path")
        said = subprocess.run([program, "--version"], capture_output=True, text=True, timeout=20, check=True, env=_ENV)
        return " ".join(said.stdout.split()[:2]) or program

    remedy = f"pip install rerun-sdk=={package_version('rerun-sdk') or '0.41.*'}"
    return _tried("rerun viewer", "harness view, trace.rrd", remedy, find)


def _beside() -> list[Check]:
    """What is there or not, and optional."""
    folders = [Path("/usr/share/vulkan/icd.d"), Path("/etc/vulkan/icd.d")]
    drivers = sorted(file.name for folder in folders if folder.is_dir() for file in folder.glob("*.json"))
    browser = next((path for name in BROWSERS if (path := shutil.which(name))), "")
    screenshots, page = (
        "screenshots of the viewer without a screen",
        "looking at report.html on this machine, and its test",
    )
    rows = [
        ("vulkan", ", ".join(drivers), "no driver", screenshots, "apt-get install libvulkan1 mesa-vulkan-drivers"),
        ("browser", browser, "none", page, "apt-get install chromium"),
    ]
    for package, (purpose, extra) in _EXTRAS.items():
        version, remedy = package_version(package), f"pip install 'friction-harness[{extra}]'"
        rows.append((package, f"version {version}" if version else "", "not installed", purpose, remedy))
    return [
        Check(
            name=name,
            ok=bool(found),
            found=found or missing,
            needed_for=f"{purpose} (optional)",
            remedy=None if found else remedy,
        )
        for name, found, missing, purpose, remedy in rows
    ]
