"""The matrix: engines x routes x settings x steps x scenarios, one Spec at a time."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from harness.engines.base import PRESETS, ROUTES, Engine, Route
from harness.fidelity import sliders
from harness.fidelity.registry import suite
from harness.fidelity.row import Spec
from harness.fidelity.variants import COARSE, FINE, FINEST, HUNDRED, OWN, WARP, Variant, variants

SHORT_SCENARIOS = ("free-decay", "free-decay-no-friction", "hold-97", "belt", "harmonic")


@dataclass(frozen=True, slots=True)
class Matrix:
    """Which rows there are.

    routes : of those an engine has. presets : names of settings, empty for all. steps : s, in place of the table's own;
    what ships keeps its own step beside them. short : what ships and what is tuned at one step each, five scenarios.
    sliders : how many suites of random sliders come after the suite's own.
    """

    routes: tuple[Route, ...] = ROUTES
    presets: tuple[str, ...] = ()
    steps: tuple[float, ...] = ()
    short: bool = False
    sliders: int = 0

    def specs(self, engines: Mapping[str, Engine]) -> Iterator[Spec]:
        """The rows of these engines, each once, in a fixed order."""
        for draw in range(self.sliders + 1):
            seen: set[str] = set()
            for name, engine in engines.items():
                for route in self.routes:
                    if route in engine.routes:
                        for spec in self._of(name, engine, route, draw):
                            if spec.key not in seen:
                                seen.add(spec.key)
                                yield spec

    def size(self, engines: Mapping[str, Engine]) -> int:
        """How many rows ``specs`` gives."""
        one = sum(1 for _ in replace(self, sliders=0).specs(engines))
        return one * (self.sliders + 1)

    def _of(self, name: str, engine: Engine, route: Route, draw: int) -> Iterator[Spec]:
        version, place = engine.version(), engine.place
        scenarios = suite(route, sliders.drawn(draw) if draw else sliders.OWN)
        for variant in variants(engine.name, route):
            if self.presets and variant.name not in self.presets:
                continue
            for dt in self._steps(variant):
                # what depends on the step is never asked for at a step that is not known
                changed = tuple(sorted(variant.settings(FINE if dt is None else dt).items()))
                for scenario in scenarios.values():
                    if self._wanted(variant, dt, bool(changed), scenario.name):
                        yield Spec(name, version, route, variant.name, variant.base, changed, dt, scenario, draw, place)

    def _steps(self, variant: Variant) -> tuple[float | None, ...]:
        if self.short:
            return tuple(dt for dt in variant.steps if dt is OWN or (variant.base == "tuned" and dt == FINE))
        if not self.steps:
            return variant.steps
        own = (OWN,) if OWN in variant.steps else ()
        return (*own, *self.steps)

    def _wanted(self, variant: Variant, dt: float | None, changed: bool, scenario: str) -> bool:
        if self.short:
            return not changed and scenario in SHORT_SCENARIOS
        if variant.name == WARP:
            return scenario == "free-decay"
        if not self.steps and dt == HUNDRED:
            # ten times the cost: the figures that are known at this step
            return scenario in ("free-decay", "free-decay-no-friction", "belt")
        if not self.steps and dt in (COARSE, FINEST):
            # outer rungs of the ladder serve the order of convergence
            return scenario in ("free-decay", "free-decay-no-friction", "belt", "harmonic")
        return True


def preset_names(engines: Mapping[str, Engine], routes: tuple[Route, ...] = ROUTES) -> tuple[str, ...]:
    """Every name of settings there is, as-shipped and tuned first."""
    found = [
        variant.name for engine in engines.values() for route in routes for variant in variants(engine.name, route)
    ]
    return tuple(dict.fromkeys([*PRESETS, *found]))
