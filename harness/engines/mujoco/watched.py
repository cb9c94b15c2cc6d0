"""A body of a compiled scene, watched while MuJoCo steps it: how it moves against what bears it, and its contacts."""

import copy
import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from harness.core.arrays import FloatArray
from harness.engines.mujoco.contacts import Tally, Touch, contacts, force_of, geoms_of
from harness.engines.mujoco.presets import CONES, SOLVERS

UNSOUND = (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC)
"""What MuJoCo warns of where a state is not finite or too large to be true."""
JACOBIANS = ("dense", "sparse", "auto")
_WORDS = {"cone": CONES, "solver": SOLVERS, "jacobian": JACOBIANS}
OPTIONS = ("cone", "impratio", "solver", "iterations", "ls_iterations", "noslip_iterations", "jacobian")
"""Of <option>: what decides how well friction holds, the step and the contacts' softness aside."""
_SAMPLES = 120
"""Moments of a run at which contacts are looked at."""
_LAST = 0.9
"""Share of a run after which a body that is in contact has not been let go."""
_SLOW = 0.05
"""Of the largest speed, from which on a body that stops is no longer read."""
_MOST = 0.25
"""Share of a run that has to be read for a deceleration."""


def options_of(model: Any) -> dict[str, Any]:
    """OPTIONS of a model, in the words of MJCF."""
    return {n: _WORDS[n][int(getattr(model.opt, n))] if n in _WORDS else getattr(model.opt, n) for n in OPTIONS}


def with_options(model: Any, changed: Mapping[str, Any]) -> Any:
    """A copy with some of OPTIONS changed."""
    found = copy.copy(model)
    for name, value in changed.items():
        setattr(found.opt, name, _WORDS[name].index(value) if name in _WORDS else value)
    return found


def is_sparse(model: Any) -> bool:
    """Whether MuJoCo keeps the Jacobian of this model's constraints as a sparse matrix."""
    return bool(mujoco.mj_isSparse(model))


@dataclass(frozen=True, slots=True)
class Watch:
    """What is watched: a body with those on it, against the bearer, along the normal (3,) of their contact in the
    bearer's frame; the start as a keyframe (-1: the model's reference), and for how long, s.
    """

    body: int
    bearer: int
    normal: FloatArray
    keyframe: int
    duration: float


@dataclass(frozen=True, slots=True)
class Seen:
    """A run; the later half of it is what is measured.

    t : s. path (n, 3) : of the body's centre of mass in the bearer's frame, m. turning (n, 3) : relative angular
    velocity there, rad/s. slip : mean speed at which the contacts slide, m/s. touching : share of moments in contact.
    use : of the friction cones, weighed by normal force; None without contact. lost : time of the last contact where
    it ends before the run does, s. diverged : the step at which it did. steps_per_s : of a processor.
    """

    watch: Watch
    t: FloatArray
    path: FloatArray
    turning: FloatArray
    slip: float
    touching: float
    use: float | None
    touches: tuple[Touch, ...]
    lost: float | None
    diverged: int | None
    steps_per_s: float

    @property
    def half(self) -> int:
        return self.t.size // 2

    @property
    def _moved(self) -> FloatArray:
        found: FloatArray = self.path - self.path[self.half]
        return found

    @property
    def lifted(self) -> FloatArray:
        """Along the normal from where the later half began, m, (n,)."""
        found: FloatArray = self._moved @ self.watch.normal
        return found

    @property
    def slid(self) -> FloatArray:
        """Across the normal from there, along the way to where it ends, m, (n,)."""
        across = self._moved - np.outer(self.lifted, self.watch.normal)
        length = float(np.linalg.norm(across[-1]))
        return across @ (across[-1] / length) if length > 0.0 else np.zeros(self.t.size)

    @property
    def creep(self) -> float:
        """Mean speed across the normal, m/s."""
        return float(self.slid[-1] / (self.t[-1] - self.t[self.half]))

    @property
    def lift(self) -> float:
        """Largest distance along the normal from where the later half began, m."""
        return float(np.max(self.lifted[self.half :]))

    @property
    def spin(self) -> float:
        """Mean rate of turning about the normal, rad/s."""
        return float(np.mean(self.turning[self.half :] @ self.watch.normal))

    @property
    def roll(self) -> float:
        """Mean rate of turning about what lies across the normal, rad/s."""
        mean = np.mean(self.turning[self.half :], axis=0)
        return float(np.linalg.norm(mean - (mean @ self.watch.normal) * self.watch.normal))

    @property
    def deceleration(self) -> float | None:
        """Of the speed across the normal, over what comes after a twentieth of the run, m/s^2; None for one that is
        not read: too short a motion, or none to speak of."""
        speed = np.diff(self.path, axis=0) / np.diff(self.t)[:, None]
        across = np.linalg.norm(speed - np.outer(speed @ self.watch.normal, self.watch.normal), axis=1)
        t = self.t[:-1]
        late = t >= _SLOW * self.t[-1]
        inside = late & (across > _SLOW * float(np.max(across)))
        if inside.sum() < _MOST * t.size or np.any(np.diff(np.flatnonzero(inside)) > 1):
            return None
        return float(-np.polyfit(t[inside], across[inside], 1)[0])


def watch_of(model: Any, body: int, keyframe: int, duration: float) -> Watch:
    """What bears a body: the one against which it is pressed most in the first half of a run, by what is welded."""
    data, own = _started(model, keyframe), geoms_of(model, body)
    pressed: dict[int, float] = {}
    normals: dict[int, FloatArray] = {}
    steps = max(2, round(0.5 * duration / float(model.opt.timestep)))
    every = max(1, steps // _SAMPLES)
    for n in range(steps):
        mujoco.mj_step(model, data)
        if any(data.warning[kind].number for kind in UNSOUND):
            break
        if n % every:
            continue
        for i, _, other, sign in contacts(data, own):
            force = float(force_of(model, data, i)[0])
            bearer = int(model.body_weldid[model.geom_bodyid[other]])
            turned = data.xmat[bearer].reshape(3, 3).T @ (sign * data.contact.frame[i, :3])
            pressed[bearer] = pressed.get(bearer, 0.0) + force
            normals[bearer] = normals.get(bearer, np.zeros(3)) + force * turned
    bearer = max(pressed, key=lambda one: pressed[one], default=0)
    normal = normals.get(bearer, np.zeros(3))
    length = float(np.linalg.norm(normal))
    return Watch(body, bearer, normal / length if length > 0.0 else np.array([0.0, 0.0, 1.0]), keyframe, duration)


def watched(model: Any, watch: Watch) -> Seen:
    """Step a model under its own options and watch a body."""
    data, h = _started(model, watch.keyframe), float(model.opt.timestep)
    steps = max(8, round(watch.duration / h))
    every, half = max(1, steps // _SAMPLES), steps // 2
    path, turning, tally = np.empty((steps + 1, 3)), np.empty((steps + 1, 3)), Tally(model, watch.body)
    diverged, spent = None, 0.0
    mujoco.mj_forward(model, data)
    for n in range(steps + 1):
        turn = data.xmat[watch.bearer].reshape(3, 3)
        path[n] = (data.xipos[watch.body] - data.xpos[watch.bearer]) @ turn
        turning[n] = (data.cvel[watch.body, :3] - data.cvel[watch.bearer, :3]) @ turn
        if n % every == 0:
            tally.look(data, n * h, late=n >= half)
        if n == steps:
            break
        began = time.process_time()
        mujoco.mj_step(model, data)
        spent += time.process_time() - began
        if any(data.warning[kind].number for kind in UNSOUND):
            diverged = n + 1
            path[n + 1 :], turning[n + 1 :] = path[n], 0.0
            break
    ends = tally.last < _LAST * steps * h
    return Seen(
        watch,
        h * np.arange(steps + 1, dtype=np.float64),
        path,
        turning,
        tally.slip,
        tally.touched / max(1, tally.looks),
        tally.use,
        tally.touches,
        tally.last if ends and diverged is None and tally.last > 0.0 else None,
        diverged,
        (diverged or steps) / max(spent, 1e-9),
    )


def _started(model: Any, keyframe: int) -> Any:
    data = mujoco.MjData(model)
    if keyframe >= 0:
        mujoco.mj_resetDataKeyframe(model, data, keyframe)
    return data
