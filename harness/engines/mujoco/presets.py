"""Settings of MuJoCo: what there is, what ships, and what we found best."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import mujoco

from harness.engines.base import TUNED_DT, Preset, Route, choice

INTEGRATORS = ("Euler", "RK4", "implicit", "implicitfast", "discrete")
SOLVERS = ("PGS", "CG", "Newton")
CONES = ("pyramidal", "elliptic")

SHIPPED_DT = 0.002
"""MuJoCo's own step, s."""

STIFF = 0.9999
"""Largest constraint impedance MuJoCo accepts (mjMAXIMP)."""


def presets(route: Route, preset: Preset, dt: float | None) -> dict[str, Any]:
    """Every setting of a preset; see harness.engines.base.Engine.presets.

    solreffriction and solimpfriction are those of the joint; solref, solimp and solreffriction those of the contact
    (there (0, 0) means: as solref, and only an elliptic cone looks at it).
    """
    shipped: dict[str, Any] = {
        "dt": SHIPPED_DT if dt is None else dt,
        "integrator": "Euler",
        "solver": "Newton",
        "iterations": 100,
        "tolerance": 1e-8,
        "ls_iterations": 50,
        "noslip_iterations": 0,
        "noslip_tolerance": 1e-6,
        "cone": "pyramidal",
        "impratio": 1.0,
        "solreffriction": (0.0, 0.0) if route == "contact" else (0.02, 1.0),
        "solimpfriction": (0.9, 0.95, 0.001, 0.5, 2.0),
        "solref": (0.02, 1.0),
        "solimp": (0.9, 0.95, 0.001, 0.5, 2.0),
    }
    return shipped if preset == "as-shipped" else shipped | _tuned(route, TUNED_DT if dt is None else dt)


def _tuned(route: Route, dt: float) -> dict[str, Any]:
    tuned: dict[str, Any] = {"dt": dt, "integrator": "RK4"}
    if route == "joint":
        # b = 1.9/dt: the friction force is reached in one step; beyond 2/dt explicit integrators chatter
        tuned |= {
            "solreffriction": (-1.0, -1.9 * STIFF / dt),
            "solimpfriction": (STIFF, STIFF, 0.001, 0.5, 2.0),
        }
    elif route == "contact":
        # a sliding contact of speed v rides up as if mu v b were taken off gravity (weighed with d/(1-d)) and bounces
        # when that exceeds g: half the impedance of rest buys room for speed, impratio keeps the grip
        tuned |= {
            "cone": "elliptic",
            "impratio": 1e5,
            "tolerance": 1e-12,
            "solref": (4.0 * dt, 1.0),
            "solimp": (0.5, 0.5, 0.001, 0.5, 2.0),
        }
    return tuned


def check(settings: dict[str, Any]) -> None:
    """Raise InputError for a name of an integrator, solver or cone that does not exist."""
    choice("mujoco setting integrator", settings["integrator"], INTEGRATORS)
    choice("mujoco setting solver", settings["solver"], SOLVERS)
    choice("mujoco setting cone", settings["cone"], CONES)


def unused(settings: dict[str, Any], shipped: dict[str, Any], route: Route) -> tuple[str, ...]:
    """Settings that differ from what ships but have no effect on this route, one sentence each."""
    reasons: dict[str, str] = {}
    if route != "contact":
        for name in ("cone", "impratio", "solref", "solimp"):
            reasons[name] = "there is no contact on this route"
    if route != "joint":
        reasons["solimpfriction"] = "the joint has no friction on this route"
    if route == "contact" and settings["cone"] == "pyramidal":
        reasons["solreffriction"] = "only an elliptic cone looks at it"
    if route == "law":
        reasons["solreffriction"] = "the joint has no friction on this route"
        for name in ("solver", "iterations", "tolerance", "ls_iterations", "noslip_iterations", "noslip_tolerance"):
            reasons[name] = "there is no constraint to solve on this route"
    elif route == "contact" and settings["cone"] == "elliptic":
        reasons["noslip_iterations"] = "does nothing with an elliptic cone unless the box can also move sideways"
    return tuple(f"{name}: {reason}" for name, reason in reasons.items() if settings[name] != shipped[name])


@contextmanager
def warned() -> Iterator[list[str]]:
    """The warnings of the block, as they come."""
    found: list[str] = []
    previous = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(found.append)
    try:
        yield found
    finally:
        mujoco.set_mju_user_warning(previous)
