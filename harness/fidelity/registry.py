"""The scenarios of the suite by name: those of harness.fidelity.scenarios, then those that other packages register.

A package adds one by an entry point of group ``harness.scenarios`` whose value is the Kind ("package.module:SCENARIO").
"""

import pkgutil
from collections.abc import Mapping
from functools import cache
from importlib import import_module

from harness.core.errors import InputError, did_you_mean
from harness.core.registered import registered
from harness.core.scenario import Scenario
from harness.engines.base import Route
from harness.fidelity import scenarios
from harness.fidelity.kind import Kind
from harness.fidelity.sliders import OWN, Sliders, scale_of

GROUP = "harness.scenarios"


@cache
def kinds() -> Mapping[str, Kind]:
    """Every scenario by its name, in the order in which they are shown. Raises InputError for a name that is taken."""
    modules = pkgutil.iter_modules(scenarios.__path__)
    files = [import_module(f"{scenarios.__name__}.{found.name}") for found in modules]
    own = [one for file in files for one in vars(file).values() if isinstance(one, Kind)]
    found: dict[str, Kind] = {}
    others = (k for _, k in registered(GROUP, Kind, "scenario"))  # type: ignore[type-abstract]  # only asked for
    for one in sorted((*own, *others), key=lambda kind: kind.place):
        if one.name in found:
            raise InputError(f"scenario {one.name}", "registered twice", "one is accepted")
        found[one.name] = one
    return found


def kind(name: str) -> Kind:
    """The scenario of this name; InputError lists those there are."""
    found = kinds().get(name)
    if found is None:
        raise InputError("scenario", repr(name), f"{', '.join(kinds())} is accepted{did_you_mean(name, kinds())}")
    return found


def kind_of(scenario: Scenario) -> Kind:
    """What a scenario is an example of; InputError for a name that is not in the suite."""
    return kind(scenario.name)


def chosen(name: str, given: Mapping[str, float | None]) -> Scenario:
    """A scenario with the values given in place of its own; None is not given. Raises InputError, see Kind.chosen."""
    return kind(name).chosen({key: value for key, value in given.items() if value is not None})


def names(route: Route) -> tuple[str, ...]:
    """Scenarios of a route, in the order in which they are shown."""
    return tuple(name for name, kind in kinds().items() if route in kind.routes)


def suite(route: Route, sliders: Sliders = OWN) -> dict[str, Scenario]:
    """Every scenario of a route by its name."""
    return {name: kind(name).of_suite(sliders, scale_of(route)) for name in names(route)}
