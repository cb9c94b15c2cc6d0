"""What works on this machine and what does not: harness doctor."""

import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from harness.app.shared.machine import package_version, this_machine
from harness.app.shared.progress import journal
from harness.results.common import Check, DoctorResult

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "firefox")
ALWAYS = ("python", "engine mujoco", "models", "numba cache", "rerun viewer")
"""Checks that must pass; the others are optional, and so are engines that this Python cannot have."""


def doctor() -> DoctorResult:
    """Look at the installation; nothing is changed and nothing is raised for what is missing."""
    with tempfile.TemporaryDirectory() as folder, journal(Path(folder) / "log.txt"):
        checks = [_python(), *_engines(), _models(), _numba_cache(), _viewer(), _vulkan(), _browser(), *_extras()]
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

    return [_engine(name) for name in registry.names()]


def _engine(name: str) -> Check:
    from harness.engines import registry

    needed = f"simulations in {name}" if f"engine {name}" in _required() else f"simulations in {name} (optional)"
    remedy = _REMEDY.get(name, f"pip install {name}")
    if name == "pybullet" and sys.version_info >= registry.NO_PYBULLET:
        remedy = "use Python 3.11: PyBullet has no wheel above it; or build it from source: pip install pybullet"
    return _tried(f"engine {name}", needed, remedy, lambda: f"version {registry.load(name).version()}")


_ELSEWHERE = "python3.11 -m venv ENV; ENV/bin/pip install {0} scipy numba platformdirs; --engine {1}@ENV/bin/python"
_REMEDY = {name: f"pip install 'friction-harness[{name}]'" for name in ("dart", "rapier", "drake")} | {
    "physx": _ELSEWHERE.format("ovphysx physx-usd-schemas newton-usd-schemas", "physx") + " (NVIDIA's licence)",
    "newton": _ELSEWHERE.format("'newton[sim]'", "newton"),
}
"""physx can also be had here as an extra; newton asks for another mujoco than ours."""


def _tried(name: str, needed_for: str, remedy: str, find: Callable[[], str]) -> Check:
    """A check that passes unless ``find`` raises."""
    try:
        return Check(name=name, ok=True, found=find(), needed_for=needed_for)
    except Exception as error:  # whatever a broken installation raises is what the doctor is to report
        return Check(
            name=name, ok=False, found=f"{type(error).__name__}: {error}", needed_for=needed_for, remedy=remedy
        )


def _models() -> Check:
    from harness.engines import models

    return _tried("models", "every simulation", "install the package again", lambda: str(models.folder()))


def _numba_cache() -> Check:
    def find() -> str:
        from harness.core.jit import cache_folder

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


_ENV = {"PATH": "/usr/bin:/bin", "RERUN_ANALYTICS": "0"}


def _vulkan() -> Check:
    folders = [Path("/usr/share/vulkan/icd.d"), Path("/etc/vulkan/icd.d")]
    drivers = sorted(file.name for folder in folders if folder.is_dir() for file in folder.glob("*.json"))
    return Check(
        name="vulkan",
        ok=bool(drivers),
        found=", ".join(drivers) or "no driver",
        needed_for="screenshots of the viewer without a screen (optional)",
        remedy=None if drivers else "apt-get install libvulkan1 mesa-vulkan-drivers",
    )


def _browser() -> Check:
    found = next((path for name in BROWSERS if (path := shutil.which(name))), None)
    return Check(
        name="browser",
        ok=found is not None,
        found=found or "none",
        needed_for="looking at report.html on this machine, and its test (optional)",
        remedy=None if found else "apt-get install chromium",
    )


def _extras() -> list[Check]:
    wanted = {"distributed": ("sweeps on a cluster", "cluster"), "rosbags": ("robot logs in ROS bags", "bags")}
    checks = []
    for package, (purpose, extra) in wanted.items():
        found = package_version(package)
        remedy = None if found else f"pip install 'friction-harness[{extra}]'"
        text = f"version {found}" if found else "not installed"
        checks.append(
            Check(name=package, ok=bool(found), found=text, needed_for=f"{purpose} (optional)", remedy=remedy)
        )
    return checks
