"""What a result is made with: versions, system, cores."""

import os
import platform
from importlib.metadata import PackageNotFoundError

from harness.core.registered import version
from harness.engines import registry
from harness.results.common import Machine

PACKAGES = (
    "friction-harness",
    "mujoco",
    "pybullet",
    "dartpy",
    "numpy",
    "scipy",
    "numba",
    "rerun-sdk",
    "pyarrow",
    "pydantic",
)


def package_version(name: str) -> str | None:
    """Version of an installed package, None when it is not installed."""
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def cores() -> int:
    """Cores this process may use."""
    return len(os.sched_getaffinity(0))


def this_machine(seeds: dict[str, int] | None = None) -> Machine:
    packages = {name: found for name in PACKAGES if (found := package_version(name)) is not None}
    return Machine(
        python=platform.python_version(),
        packages=packages,
        system=f"{platform.system()} {platform.release()} {platform.machine()}",
        cores=cores(),
        seeds=seeds or {},
    )


def left_out() -> tuple[str, ...]:
    """A sentence for each engine that is usually taken and that this Python cannot have."""
    return tuple(
        f"{name} is not run: it has no wheel for this Python; harness doctor says what to do"
        for name in registry.USUAL
        if name not in registry.usual()
    )
