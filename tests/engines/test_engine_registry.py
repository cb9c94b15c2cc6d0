"""Engines by name: those that are there, those that are not, and one of a third party."""

from importlib.metadata import EntryPoint
from typing import Any

import pytest

from harness.core.errors import InputError, SimulationError
from harness.engines import registry


@pytest.mark.usefixtures("pybullet")
def test_the_engines_of_the_house_are_registered() -> None:
    assert {"mujoco", "pybullet"} <= set(registry.names())
    assert registry.load("mujoco").name == "mujoco"
    assert registry.load("pybullet").version() == "3.2.7"


def point(name: str, value: str) -> EntryPoint:
    return EntryPoint(name, value, registry.GROUP)


def test_what_is_no_engine_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(registry, "entry_points", lambda group: (point("odd", "collections:OrderedDict"),))
    with pytest.raises(SimulationError, match=r"engine odd: collections:OrderedDict is not a harness\.engines"):
        registry.load("odd")


def test_without_any_engine_the_message_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    nothing: tuple[Any, ...] = ()
    monkeypatch.setattr(registry, "entry_points", lambda group: nothing)
    with pytest.raises(InputError, match="none is registered: install the package"):
        registry.load("mujoco")
