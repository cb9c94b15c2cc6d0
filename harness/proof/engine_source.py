"""A second source of recordings: MuJoCo and PyBullet at converged settings, the effect a hidden force.

The plant says what is hidden; the engine has spring, damper and dry friction and makes the motion.
"""

from functools import partial
from typing import Literal

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, SimulationError
from harness.proof.engine_source_motion import Body, Task, run
from harness.proof.plant.cases import MOST_TRIES, Case, accepted, draw, record
from harness.proof.plant.effects import ALIENS, KINDS
from harness.proof.plant.integrate import PlantRun
from harness.proof.plant.model import PlantModel

EngineName = Literal["mujoco", "pybullet"]
ENGINES: tuple[EngineName, ...] = ("mujoco", "pybullet")

STATEFUL = ("presliding", "viscoelastic", "attached-mode", "static-friction", "alien-heating", "alien-rattle")
"""What no force of position, speed and time says: states of their own, a level that rises when at rest."""
ENGINE_KINDS = tuple(kind for kind in (*KINDS, *ALIENS) if kind not in STATEFUL)
"""Names that an engine can hide."""


def draw_engine(
    kind: str | tuple[str, ...], rng: np.random.Generator, engine: EngineName = "mujoco", *, noise: str = "white"
) -> Case:
    """A random case whose motion an engine made: a name of ENGINE_KINDS, "control", or a pair of names.

    Concealed and decidable as the plant's own draws are, and by the same test. Raises InputError for a name that an
    engine cannot hide and for another engine, SimulationError when nothing came out.
    """
    kinds = () if kind == "control" else (kind,) if isinstance(kind, str) else kind
    for name in kinds:
        if name not in ENGINE_KINDS:
            raise InputError("kind", name, f"control or one of {', '.join(ENGINE_KINDS)} is accepted")
    if engine not in ENGINES:
        raise InputError("engine", engine, f"one of {', '.join(ENGINES)} is accepted")
    motion = partial(engine_motion, engine=engine)
    for _ in range(MOST_TRIES):
        plan = draw(kind, rng, noise=noise)
        # what the plant made is thrown away: its noise too is drawn anew
        again = record(plan.base, plan.effects, plan.setting, plan.channels, plan.noise, rng, motion, engine)
        case = accepted(again)
        if case is not None:
            return case
    raise SimulationError(f"{engine}: no concealed and decidable draw of {' + '.join(kinds)} in {MOST_TRIES} tries")


def engine_motion(model: PlantModel, t: FloatArray, engine: EngineName) -> PlantRun:
    """The motion at the times t (s, shape (n,), from 0 on) in an engine.

    Raises SimulationError for a plant that no engine can be told and for a motion that is not finite.
    """
    task = Task(model, float(t[-1]))
    body = _body(task, engine)
    try:
        found = run(task, body, t)
    finally:
        body.close()
    if not np.all(np.isfinite(found.x)):
        raise SimulationError(f"{engine}: the motion is not finite")
    return found


def _body(task: Task, engine: EngineName) -> Body:
    if engine == "mujoco":
        from harness.proof.engine_source_mujoco import MujocoBody

        return MujocoBody(task)
    try:
        from harness.proof.engine_source_pybullet import PybulletBody
    except ImportError as error:
        raise SimulationError(f"engine {engine}: not installed ({error}); the proof draws recordings in it") from None
    return PybulletBody(task)
