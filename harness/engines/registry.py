"""Engines by name, found through the entry points of group harness.engines; a third party adds one the same way.

NAME@PYTHON is the engine NAME in another interpreter: another version of it, or one whose packages clash with ours.
"""

import sys
from collections.abc import Sequence
from importlib.metadata import EntryPoint
from importlib.util import find_spec

from harness.core import registered
from harness.core.checks import positive
from harness.core.errors import InputError, SimulationError, did_you_mean
from harness.engines.base import PRESETS, Engine, Preset, choice
from harness.engines.elsewhere.remote import engine_in

GROUP = "harness.engines"


USUAL = ("mujoco", "pybullet")
"""Engines taken where nobody names any."""
NO_PYBULLET = (3, 12)
"""Python from which on pybullet has no wheel, and is no dependency of ours (pyproject.toml says the same)."""


def usual() -> tuple[str, ...]:
    """Engines taken where nobody names any: MuJoCo, and PyBullet where a Python can have it or somebody built it."""
    without = sys.version_info >= NO_PYBULLET and not _is_there("pybullet")
    return tuple(name for name in USUAL if not (without and name == "pybullet"))


def _is_there(package: str) -> bool:
    try:
        return find_spec(package) is not None
    except ValueError:  # it stands in sys.modules, and is no module
        return False


def _found() -> dict[str, EntryPoint]:
    return {point.name: point for point in registered.points(GROUP)}


def names() -> tuple[str, ...]:
    """Names of all engines that are registered, installed or not, in alphabetical order."""
    return tuple(sorted(_found()))


def check(name: str, where: str = "engine") -> None:
    """Raise InputError, about ``where``, for a name that is not registered; what follows an @ is not looked at."""
    found, bare = names(), name.partition("@")[0]
    if bare not in found:
        accepted = f"one of {', '.join(found)}{did_you_mean(bare, found)}"
        if not found:
            accepted = "an installed package that registers engines (none does)"
        raise InputError(where, repr(name), accepted)


def check_asked(engines: Sequence[str], presets: Sequence[str] = (), dt: float | None = None) -> None:
    """Raise InputError for an engine or a preset that there is not, and for a step, s, not above 0: as options."""
    if dt is not None:
        positive("--dt", dt, "s")
    for preset in presets:
        choice("--preset", preset, PRESETS)
    for name in engines:
        check(name, "--engine")


def runs(engines: Sequence[str], presets: Sequence[str]) -> list[tuple[str, Preset]]:
    """Engine and preset of every run; an engine that is asked for twice is run once."""
    return [(name, preset) for name in dict.fromkeys(engines) for preset in PRESETS if preset in presets]


def load(name: str) -> Engine:
    """The engine of this name, or NAME@PYTHON.

    Raises InputError listing the names there are for an unknown one and for an interpreter that is none,
    SimulationError with the reason when the package that an engine needs is not installed or cannot be loaded.
    """
    check(name)
    bare, _, python = name.partition("@")
    point = _found()[bare]
    try:
        engine = engine_in(python, point.value) if python else point.load()()
    except ImportError as error:
        raise SimulationError(f"engine {name}: not installed ({error})") from error
    except SimulationError as error:
        raise SimulationError(f"engine {name}: {error}") from error
    if not isinstance(engine, Engine):
        raise SimulationError(f"engine {name}: {point.value} is not a harness.engines.base.Engine")
    return engine


def available() -> dict[str, str | None]:
    """Every registered engine with None when it can be used, else with the reason why not."""
    state: dict[str, str | None] = {}
    for name in names():
        try:
            load(name)
            state[name] = None
        except SimulationError as error:
            state[name] = str(error)
    return state
