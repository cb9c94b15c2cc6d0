"""The matrix: engines x routes x settings x steps x scenarios, one Spec at a time.

Settings worth knowing about, engine by engine: what ships, what changes it, what repairs it.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from harness.core.scenario import Scenario
from harness.engines.base import PRESETS, ROUTES, Engine, Preset, Route
from harness.fidelity.kind import OWN as OWN_SLIDERS
from harness.fidelity.kind import Sliders, drawn, suite
from harness.fidelity.row import Spec
from harness.fidelity.select import Selection

Settings = Mapping[str, Any]
STIFF = 0.9999
"""Largest impedance MuJoCo accepts."""
OWN: float | None = None
"""The step that the engine ships with."""


def _nothing(dt: float) -> Settings:
    return {}


@dataclass(frozen=True, slots=True)
class Variant:
    """A named change of settings.

    name : as the column "preset" shows it. base : preset it starts from. steps : s, OWN for the preset's own.
    settings : overrides for a step of dt (s); a variant with overrides that depend on dt never runs at OWN.
    """

    name: str
    base: Preset
    steps: tuple[float | None, ...]
    settings: Callable[[float], Settings] = field(default=_nothing)


def _fixed(**settings: Any) -> Callable[[float], Settings]:
    return lambda dt: settings


def _stiff_joint(integrator: str) -> Callable[[float], Settings]:
    """A friction that is reached in two steps, with the largest impedance."""
    return lambda dt: {
        "integrator": integrator,
        "solreffriction": (2.0 * dt, 1.0),
        "solimpfriction": (STIFF, STIFF, 0.001, 0.5, 2.0),
    }


def _stiff_contact(cone: str) -> Callable[[float], Settings]:
    return lambda dt: {"cone": cone, "solref": (2.0 * dt, 1.0), "solimp": (STIFF, STIFF, 0.001, 0.5, 2.0)}


COARSE, MIDDLE, FINE, FINEST = 4e-3, 2e-3, 1e-3, 5e-4
LADDER = (COARSE, MIDDLE, FINE, FINEST)
"""Steps from which the order of convergence is measured, s."""
HUNDRED = 1e-4

_SHIPPED, _SHIPPED_ALONE = (Variant("as-shipped", "as-shipped", steps) for steps in ((OWN, FINE), (OWN,)))
_TUNED, _TUNED_LADDER = (Variant("tuned", "tuned", steps) for steps in ((MIDDLE, FINE), LADDER))
_EVERY = (_SHIPPED, _TUNED_LADDER)
"""What every engine is asked for, a third party's too."""
_LAW = (_SHIPPED, _TUNED)

_MUJOCO_JOINT = (
    Variant("as-shipped", "as-shipped", (OWN, COARSE, FINE, FINEST)),
    *(
        Variant("as-shipped", "as-shipped", (MIDDLE, FINE), _fixed(integrator=name))
        for name in ("implicit", "implicitfast", "discrete")
    ),
    Variant("as-shipped", "as-shipped", (MIDDLE, FINE, HUNDRED), _fixed(integrator="RK4")),
    Variant("as-shipped", "as-shipped", (MIDDLE,), _fixed(solver="PGS")),
    Variant("as-shipped", "as-shipped", (MIDDLE,), _fixed(solver="CG")),
    Variant("noslip", "as-shipped", (MIDDLE,), _fixed(noslip_iterations=50)),
    Variant("stiff", "as-shipped", (FINE,), _stiff_joint("implicitfast")),
    Variant("stiff", "as-shipped", (FINE, HUNDRED), _stiff_joint("RK4")),
    Variant("stiff", "as-shipped", (FINE,), _stiff_joint("discrete")),
    _TUNED_LADDER,
)
_MUJOCO_LAW = (
    _SHIPPED,
    Variant("as-shipped", "as-shipped", (FINE,), _fixed(integrator="implicitfast")),
    _TUNED,
)
_MUJOCO_CONTACT = (
    _SHIPPED,
    *(
        Variant("elliptic", "as-shipped", (FINE,), _fixed(cone="elliptic", impratio=ratio))
        for ratio in (1.0, 10.0, 100.0)
    ),
    Variant("pyramidal", "as-shipped", (FINE,), _fixed(impratio=100.0)),
    Variant("noslip", "as-shipped", (FINE,), _fixed(noslip_iterations=50)),
    Variant("noslip", "as-shipped", (FINE,), _fixed(cone="elliptic", noslip_iterations=50)),
    Variant("stiff", "as-shipped", (FINE,), _stiff_contact("pyramidal")),
    Variant("stiff", "as-shipped", (FINE,), _stiff_contact("elliptic")),
    Variant("tuned", "tuned", (MIDDLE, FINE, FINEST)),
)
SEMI_IMPLICIT = Variant("undamped", "tuned", (1.0 / 240.0, FINE, HUNDRED), _fixed(leapfrog=False))
"""PyBullet without its own damping, each step read as it stands."""

_PYBULLET_JOINT = (
    _SHIPPED,
    SEMI_IMPLICIT,
    Variant("tuned", "tuned", (1.0 / 240.0, *LADDER)),
)
_PYBULLET_CONTACT = (
    _SHIPPED,
    *(
        Variant("undamped", "tuned", (1.0 / 240.0,), _fixed(leapfrog=False, numSolverIterations=count, **more))
        for count, more in (
            (10, {"solverResidualThreshold": 1e-7}),
            (50, {"solverResidualThreshold": 1e-7}),
            (50, {"solverResidualThreshold": 0.0}),
            (500, {"solverResidualThreshold": 0.0}),
        )
    ),
    Variant("anchored", "tuned", (1.0 / 240.0,), _fixed(frictionAnchor=True)),
    Variant("tuned", "tuned", (1.0 / 240.0, MIDDLE)),
)

_PUSHED = Variant("pushed", "as-shipped", (FINE,), _fixed(own_spring=False))
"""Spring and damper as a force held over the step, sub-steps as shipped."""
_RAPIER_JOINT = (
    _SHIPPED,
    _PUSHED,
    Variant("pushed", "as-shipped", (FINE,), _fixed(own_spring=False, num_solver_iterations=1)),
    _TUNED_LADDER,
)
_RAPIER_CONTACT = (
    _SHIPPED,
    Variant("coulomb", "as-shipped", (FINE,), _fixed(friction_model="COULOMB")),
    _TUNED,
)
_PHYSX_JOINT = (
    _SHIPPED,
    _PUSHED,
    Variant("viscous", "as-shipped", (FINE,), _fixed(own_spring=False, own_viscous=True, solverType="PGS")),
    Variant("switched", "as-shipped", (FINE,), _fixed(own_break_away=False)),
    Variant("once a step", "as-shipped", (FINE,), _fixed(own_spring=False, enableExternalForcesEveryIteration=False)),
    Variant("pushed", "as-shipped", (FINE,), _fixed(own_spring=False, solverType="PGS")),
    _TUNED_LADDER,
)
_DRAKE_CONTACT = (
    _SHIPPED_ALONE,
    *(
        Variant(name[1:].lower(), "as-shipped", (FINE,), _fixed(contact_approximation=name))
        for name in ("kTamsi", "kSimilar", "kSap")
    ),
    Variant("lagged", "as-shipped", (FINE,), _fixed(stiction_tolerance=1e-6)),
    _TUNED,
)
WARP = "warp"
"""Newton as it ships to the letter: many times the cost without a GPU, and the same motion to six digits."""
_NEWTON = (
    _SHIPPED,
    Variant(WARP, "as-shipped", (OWN,), _fixed(use_mujoco_cpu=False)),
    Variant("tuned", "tuned", (FINE,)),
)

GPU = "gpu"
"""As shipped on a GPU; these rows are made where somebody asks for them by name."""
_MJX_JOINT = (
    _SHIPPED,
    Variant("as-shipped", "as-shipped", (OWN, FINE), _fixed(precision=64)),
    Variant("stiff", "as-shipped", (FINE,), _stiff_joint("implicitfast")),
    _TUNED,
    Variant("tuned", "tuned", (FINE,), _fixed(precision=32)),
    *(Variant(GPU, "as-shipped", (OWN,), _fixed(device="gpu", precision=bits)) for bits in (32, 64)),
)
_WARP_JOINT = (
    _SHIPPED,
    Variant("stiff", "as-shipped", (FINE,), _stiff_joint("implicitfast")),
    _TUNED,
    Variant(GPU, "as-shipped", (OWN,), _fixed(device="gpu")),
)
_BATCHED_CONTACT = (
    _SHIPPED_ALONE,
    Variant("elliptic", "as-shipped", (FINE,), _fixed(cone="elliptic", impratio=100.0)),
    Variant("tuned", "tuned", (FINE,)),
)

TRAINED = "trained"
"""Settings as policies are trained with: few iterations of the solver and of its line search."""
EFFORTS = ((100, 50), (100, 8), (4, 8), (4, 20), (4, 30), (4, 50), (1, 50), (1, 30), (1, 4), (1, 1))
"""iterations and ls_iterations, of which the first are what MuJoCo ships with."""


def _efforts(more: Callable[[float], Settings], chosen: tuple[tuple[int, int], ...] = EFFORTS) -> Iterator[Variant]:
    """more : settings beside the effort, for a step."""
    for iterations, ls_iterations in chosen:
        effort = {"iterations": iterations, "ls_iterations": ls_iterations}
        yield Variant(TRAINED, "as-shipped", (MIDDLE,), lambda dt, effort=effort: {**more(dt), **effort})  # type: ignore[misc]


def _with(more: Callable[[float], Settings], **settings: Any) -> Variant:
    return Variant(TRAINED, "as-shipped", (MIDDLE,), lambda dt: {**more(dt), **settings})


def _rounded(more: Callable[[float], Settings], chosen: tuple[tuple[int, int], ...]) -> Iterator[Variant]:
    """Efforts in single and in double precision."""
    for bits in (32, 64):
        yield from _efforts(lambda dt, bits=bits: {**more(dt), "precision": bits}, chosen)  # type: ignore[misc]


_HARD_CONE = _fixed(cone="elliptic", impratio=100.0)
_SHORTER = ((100, 50), (4, 8), (1, 4))
_FEWER = ((100, 50), (4, 8), (4, 20), (4, 30), (4, 50), (1, 50), (1, 4))
_FEWEST = ((100, 50), (4, 8), (4, 50), (1, 50))
_LONGER = ((100, 50), (4, 8), (4, 30), (4, 50), (1, 50))
_EFFORT: dict[tuple[str, Route], tuple[Variant, ...]] = {
    ("mujoco", "joint"): (
        *_efforts(_stiff_joint("Euler")),
        *_efforts(_stiff_joint("implicitfast"), _LONGER),
        *(_with(_stiff_joint("Euler"), tolerance=value) for value in (1e-5, 0.0)),
        _with(_stiff_joint("Euler"), noslip_iterations=10),
        _with(_stiff_joint("Euler"), iterations=4, ls_iterations=8, noslip_iterations=10),
    ),
    ("mujoco", "contact"): (
        *_efforts(_HARD_CONE),
        *_efforts(_nothing, _SHORTER),
        *_efforts(_fixed(cone="elliptic"), _SHORTER),
        *(_with(_HARD_CONE, tolerance=value) for value in (1e-5, 0.0)),
    ),
    # MJX compiles each effort for itself
    ("mjx", "joint"): tuple(_rounded(_stiff_joint("Euler"), _FEWER)),
    ("mjx", "contact"): tuple(_rounded(_HARD_CONE, _FEWEST)),
    ("warp", "joint"): (
        *_efforts(_stiff_joint("Euler"), _FEWER),
        _with(_stiff_joint("Euler"), iterations=4, ls_iterations=8, noslip_iterations=10),
    ),
    ("warp", "contact"): tuple(_efforts(_HARD_CONE, _FEWEST)),
}
"""Engines whose effort can be set."""
_BODIES: dict[str, tuple[Variant, ...]] = {
    "mujoco": (
        _SHIPPED_ALONE,
        *(
            Variant("elliptic", "as-shipped", (MIDDLE,), _fixed(cone="elliptic", impratio=ratio))
            for ratio in (1.0, 10.0, 100.0)
        ),
        Variant("noslip", "as-shipped", (MIDDLE,), _fixed(noslip_iterations=10)),
        Variant("noslip", "as-shipped", (MIDDLE,), _fixed(cone="elliptic", noslip_iterations=10)),
        Variant("tuned", "tuned", (FINE,)),
    ),
}
"""Settings that bodies with six freedoms are run with, where they are not just what ships and what is tuned."""
_CURVES = (_SHIPPED_ALONE, _TUNED)
"""Settings that belts with a curve of friction are run with."""
EFFORT_SCENARIOS = ("free-decay", "hold-50")
"""Of the suite, which effort is looked at beside holds that slide first."""

_TABLE: dict[tuple[str, Route], tuple[Variant, ...]] = {
    ("rapier", "joint"): _RAPIER_JOINT,
    ("rapier", "contact"): _RAPIER_CONTACT,
    ("rapier", "law"): _LAW,
    ("physx", "joint"): _PHYSX_JOINT,
    ("physx", "law"): _LAW,
    ("drake", "contact"): _DRAKE_CONTACT,
    ("drake", "law"): (_SHIPPED_ALONE, _TUNED),
    ("newton", "joint"): _NEWTON,
    ("newton", "law"): (_SHIPPED_ALONE, Variant("tuned", "tuned", (COARSE,))),
    ("mjx", "joint"): _MJX_JOINT,
    ("mjx", "law"): (_SHIPPED_ALONE, Variant("tuned", "tuned", (FINE,))),
    ("mjx", "contact"): _BATCHED_CONTACT,
    ("warp", "joint"): _WARP_JOINT,
    ("warp", "law"): (_SHIPPED_ALONE, Variant("tuned", "tuned", (FINE,))),
    ("warp", "contact"): _BATCHED_CONTACT,
    ("mujoco", "joint"): _MUJOCO_JOINT,
    ("mujoco", "law"): _MUJOCO_LAW,
    ("mujoco", "contact"): _MUJOCO_CONTACT,
    ("pybullet", "joint"): _PYBULLET_JOINT,
    ("pybullet", "law"): _LAW,
    ("pybullet", "contact"): _PYBULLET_CONTACT,
}


def variants(engine: str, route: Route) -> tuple[Variant, ...]:
    """The variants of an engine on a route; every engine has at least what ships and what is tuned."""
    return _TABLE.get((engine, route), _EVERY)


def effort_variants(engine: str, route: Route) -> tuple[Variant, ...]:
    """Those of an engine whose solver's effort can be set, on a route."""
    return _EFFORT.get((engine, route), ())


SHORT_SCENARIOS = ("free-decay", "free-decay-no-friction", "hold-97", "belt", "harmonic")


@dataclass(frozen=True, slots=True)
class Matrix:
    """Which rows there are.

    routes : of those an engine has. presets : names of settings, empty for all. steps : s, in place of the table's own;
    what ships keeps its own step beside them. short : what ships and what is tuned at one step each, five scenarios.
    sliders : how many suites of random sliders come after the suite's own. rows : which of all these.
    """

    routes: tuple[Route, ...] = ROUTES
    presets: tuple[str, ...] = ()
    steps: tuple[float, ...] = ()
    short: bool = False
    sliders: int = 0
    rows: Selection = field(default_factory=Selection)

    def specs(self, engines: Mapping[str, Engine]) -> Iterator[Spec]:
        """The rows of these engines, each once, in a fixed order."""
        for draw in range(self.sliders + 1):
            seen: set[str] = set()
            for name, engine in engines.items():
                for route in self.routes:
                    if route in engine.routes:
                        for spec in self._of(name, engine, route, draw):
                            if spec.key not in seen and self.rows.runs(spec.name):
                                seen.add(spec.key)
                                yield spec

    def size(self, engines: Mapping[str, Engine]) -> int:
        """How many rows ``specs`` gives."""
        if self.rows != Selection():  # a pattern may mean one slider and not another
            return sum(1 for _ in self.specs(engines))
        return sum(1 for _ in replace(self, sliders=0).specs(engines)) * (self.sliders + 1)

    def _of(self, name: str, engine: Engine, route: Route, draw: int) -> Iterator[Spec]:
        version, place, sliders = engine.version(), engine.place, drawn(draw) if draw else OWN_SLIDERS
        for variant, scenarios in self._parts(engine, route, sliders):
            if variant.name not in self.presets if self.presets else variant.name == GPU:
                continue
            for dt in self._steps(variant):
                # what depends on the step is never asked for at a step that is not known
                changed = tuple(sorted(variant.settings(FINE if dt is None else dt).items()))
                for scenario in scenarios.values():
                    if self._wanted(variant, dt, bool(changed), scenario.name):
                        yield Spec(name, version, route, variant.name, variant.base, changed, dt, scenario, draw, place)

    def _parts(
        self, engine: Engine, route: Route, sliders: Sliders
    ) -> Iterator[tuple[Variant, Mapping[str, Scenario]]]:
        """Settings, each with the scenarios that are run with it: the suite's, those of effort, bodies, curves."""
        scenarios = suite(route, sliders)
        yield from ((variant, scenarios) for variant in variants(engine.name, route))
        trained = suite(route, sliders, "trained") | {name: scenarios[name] for name in EFFORT_SCENARIOS}
        yield from ((variant, trained) for variant in effort_variants(engine.name, route))
        if engine.bodies and (bodies := suite(route, sliders, "bodies")):
            yield from ((variant, bodies) for variant in _BODIES.get(engine.name, _LAW))
        if engine.calls or engine.curves:
            yield from ((variant, suite(route, sliders, "laws")) for variant in _CURVES)

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
        variant.name
        for engine in engines.values()
        for route in routes
        for variant in (*variants(engine.name, route), *effort_variants(engine.name, route))
    ]
    return tuple(dict.fromkeys([*PRESETS, *found]))
