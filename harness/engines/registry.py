"""Engines by name, found through the entry points of group harness.engines; a third party adds one the same way."""

from importlib.metadata import EntryPoint, entry_points

from harness.core.errors import InputError, SimulationError
from harness.engines.base import Engine

GROUP = "harness.engines"


def _found() -> dict[str, EntryPoint]:
    return {point.name: point for point in entry_points(group=GROUP)}


def names() -> tuple[str, ...]:
    """Names of all engines that are registered, installed or not, in alphabetical order."""
    return tuple(sorted(_found()))


def load(name: str) -> Engine:
    """The engine of this name.

    Raises InputError listing the names there are for an unknown one, SimulationError with the reason when the package
    that an engine needs is not installed or cannot be loaded.
    """
    found = _found()
    if name not in found:
        accepted = (
            f"one of {', '.join(sorted(found))} is accepted" if found else "none is registered: install the package"
        )
        raise InputError("engine", repr(name), accepted)
    try:
        engine = found[name].load()()
    except ImportError as error:
        raise SimulationError(f"engine {name}: not installed ({error})") from error
    if not isinstance(engine, Engine):
        raise SimulationError(f"engine {name}: {found[name].value} is not a harness.engines.base.Engine")
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
