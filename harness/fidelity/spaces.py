"""What can be set, engine by engine: axes of values, and the settings that a choice of them means."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from harness.engines.base import Route

Choice = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Axis:
    """One thing to choose. values : the first is what ships."""

    name: str
    values: tuple[Any, ...]


@dataclass(frozen=True, slots=True)
class Space:
    """axes : what to choose. settings : overrides of the as-shipped preset for a choice and a step (s)."""

    axes: tuple[Axis, ...]
    settings: Callable[[Choice, float], dict[str, Any]]

    def shipped(self) -> dict[str, Any]:
        """The choice that changes nothing."""
        return {axis.name: axis.values[0] for axis in self.axes}


SHIPPED = "as shipped"
"""A value that leaves a setting alone."""

_INTEGRATORS = Axis("integrator", ("Euler", "implicitfast", "implicit", "RK4", "discrete"))
_NOSLIP = Axis("noslip_iterations", (0, 5, 50))


def _plain(choice: Choice, dt: float) -> dict[str, Any]:
    return {name: value for name, value in choice.items() if value != SHIPPED}


def _mujoco_joint(choice: Choice, dt: float) -> dict[str, Any]:
    """rate : friction follows at b = rate/dt, as solreffriction (-1, -rate d/dt). impedance : d, of solimpfriction."""
    settings = _plain({k: v for k, v in choice.items() if k not in ("rate", "impedance")}, dt)
    d = 0.95 if choice["impedance"] == SHIPPED else choice["impedance"]
    if choice["impedance"] != SHIPPED:
        settings["solimpfriction"] = (d, d, 0.001, 0.5, 2.0)
    if choice["rate"] != SHIPPED:
        settings["solreffriction"] = (-1.0, -choice["rate"] * d / dt)
    return settings


def _mujoco_contact(choice: Choice, dt: float) -> dict[str, Any]:
    """steps : time constant of the contact in steps. impedance : of solimp, at any depth."""
    settings = _plain({k: v for k, v in choice.items() if k not in ("steps", "impedance")}, dt)
    if choice["impedance"] != SHIPPED:
        settings["solimp"] = (choice["impedance"], choice["impedance"], 0.001, 0.5, 2.0)
    if choice["steps"] != SHIPPED:
        settings["solref"] = (choice["steps"] * dt, 1.0)
    return settings


_IMPEDANCE = (SHIPPED, 0.5, 0.8, 0.9, 0.95, 0.99, 0.999, 0.9999)
_BULLET = (
    Axis("linearDamping", (0.04, 0.0)),
    Axis("angularDamping", (0.04, 0.0)),
    Axis("maxJointVelocity", (100.0, 1e9)),
    Axis("leapfrog", (False, True)),
    Axis("numSubSteps", (0, 2, 4)),
)
_BULLET_CONTACT = (
    Axis("numSolverIterations", (50, 10, 200, 500)),
    Axis("solverResidualThreshold", (1e-7, 0.0)),
    Axis("frictionAnchor", (False, True)),
)

_LEAPFROG = Axis("leapfrog", (False, True))
_OWN_SPRING = (Axis("own_spring", (True, False)), _LEAPFROG)
_RAPIER = (Axis("num_solver_iterations", (4, 1, 2, 8)), Axis("num_internal_pgs_iterations", (1, 4)))
_PHYSX = (
    *_OWN_SPRING,
    Axis("solverType", ("TGS", "PGS")),
    Axis("solverPositionIterationCount", (4, 1, 8, 16)),
    Axis("solverVelocityIterationCount", (1, 0, 4)),
    Axis("enableExternalForcesEveryIteration", (True, False)),
)
_DRAKE_CONTACT = (
    _LEAPFROG,
    Axis("contact_approximation", ("kLagged", "kTamsi", "kSimilar", "kSap")),
    Axis("stiction_tolerance", (1e-4, 1e-5, 1e-6, 1e-8)),
)

_NEWTON = (
    _LEAPFROG,
    Axis("integrator", ("euler", "implicitfast", "rk4")),
)

_RATE = Axis("rate", (SHIPPED, 0.05, 0.1, 0.2, 0.5, 1.0, 1.4, 1.7, 1.9, 1.98))
_SPACES: dict[tuple[str, Route], Space] = {
    ("mujoco", "joint"): Space(
        (
            _INTEGRATORS,
            _RATE,
            Axis("impedance", _IMPEDANCE),
            _NOSLIP,
        ),
        _mujoco_joint,
    ),
    ("mujoco", "contact"): Space(
        (
            _INTEGRATORS,
            Axis("cone", ("pyramidal", "elliptic")),
            Axis("impratio", (1.0, 10.0, 100.0, 1e3, 1e5)),
            Axis("steps", (SHIPPED, 2.0, 3.0, 4.0, 6.0, 10.0)),
            Axis("impedance", _IMPEDANCE),
            _NOSLIP,
            Axis("tolerance", (1e-8, 1e-12)),
        ),
        _mujoco_contact,
    ),
    ("mujoco", "law"): Space((_INTEGRATORS,), _plain),
    ("pybullet", "joint"): Space(_BULLET, _plain),
    ("pybullet", "law"): Space(_BULLET, _plain),
    ("pybullet", "contact"): Space((*_BULLET, *_BULLET_CONTACT), _plain),
    ("dart", "joint"): Space((_LEAPFROG,), _plain),
    ("dart", "law"): Space((_LEAPFROG,), _plain),
    ("rapier", "joint"): Space((*_OWN_SPRING, *_RAPIER), _plain),
    ("rapier", "law"): Space((*_OWN_SPRING, *_RAPIER), _plain),
    ("rapier", "contact"): Space((_LEAPFROG, *_RAPIER, Axis("friction_model", ("SIMPLIFIED", "COULOMB"))), _plain),
    ("physx", "joint"): Space(_PHYSX, _plain),
    ("physx", "law"): Space(_PHYSX, _plain),
    ("drake", "contact"): Space(_DRAKE_CONTACT, _plain),
    ("drake", "law"): Space((_LEAPFROG,), _plain),
    ("newton", "joint"): Space((*_NEWTON, _RATE, Axis("impedance", _IMPEDANCE)), _mujoco_joint),
    ("newton", "law"): Space(_NEWTON, _plain),
}


def space(engine: str, route: Route) -> Space | None:
    """What can be searched; None for an engine or route without a table here."""
    return _SPACES.get((engine, route))


def tunable() -> tuple[str, ...]:
    """Engines with a table, with their routes in brackets."""
    names = dict.fromkeys(engine for engine, _ in _SPACES)
    return tuple(f"{name} ({', '.join(route for one, route in _SPACES if one == name)})" for name in names)
