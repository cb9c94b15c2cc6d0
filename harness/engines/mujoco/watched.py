"""A body of a compiled scene, watched while MuJoCo steps it: how it moves against what bears it, and its contacts."""

import copy
import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from harness.core.arrays import FloatArray
from harness.engines.mujoco.contacts import Tally, Touch, bearer_of, contacts, force_of, geoms_of
from harness.engines.mujoco.presets import CONES, SOLVERS

UNSOUND = (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC)
"""What MuJoCo warns of where a state is not finite or too large to be true."""
JACOBIANS = ("dense", "sparse", "auto")
_WORDS = {"cone": CONES, "solver": SOLVERS, "jacobian": JACOBIANS}
OPTIONS = ("cone", "impratio", "solver", "iterations", "ls_iterations", "noslip_iterations", "jacobian")
"""Of <option>: what decides how well friction holds, the step and the contacts' softness aside."""
_SAMPLES = 120
"""Moments of a run at which contacts are looked at."""
_APART = 5e-3
"""m between a body and all that held it at a run's end, from which on it has been let go: more than a hop."""
_EARLY, _LATE = 0.05, 0.5
"""Shares of a run: as long from its first contact, and from then on, what holds a body is looked for."""
_FALLEN = 1e-3
"""m, by which a body that is no longer held lies lower."""
_HOLDS = 0.05
"""Of all that presses on a body, from which on something holds it."""
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
    bearer's frame; bearers : all that hold it, the bearer among them; the start as a keyframe (-1: the model's
    reference), and for how long, s.
    """

    body: int
    bearer: int
    bearers: frozenset[int]
    normal: FloatArray
    keyframe: int
    duration: float


@dataclass(frozen=True, slots=True)
class Seen:
    """A run; the later half of it is what is measured.

    t : s. path (n, 3) : of the body's centre of mass in the bearer's frame, m. turning (n, 3) : relative angular
    velocity there, rad/s. slip : mean speed at which the contacts slide, m/s. touching : share of moments in contact.
    use : of the friction cones, weighed by normal force; None without contact. strained : the same over the whole run,
    as long as the bearers hold it. lost : time of the last contact with them where it ends before the run does, s.
    diverged : the step at which it did. steps_per_s : of a processor, of most steps.
    """

    watch: Watch
    t: FloatArray
    path: FloatArray
    turning: FloatArray
    slip: float
    touching: float
    use: float | None
    strained: float | None
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
    """What bears a body, by what is welded: that which is pressed against it in the later half of a run; where it has
    fallen from all that held it at first, that.
    """
    data, own = _started(model, keyframe), geoms_of(model, body)
    early, late = _Pressed(), _Pressed()
    h = float(model.opt.timestep)
    steps = max(2, round(duration / h))
    every, first, began = max(1, steps // _SAMPLES), steps, np.zeros(3)
    for n in range(steps):
        mujoco.mj_step(model, data)
        if any(data.warning[kind].number for kind in UNSOUND):
            break
        if n % every:
            continue
        for i, _, other, sign in contacts(data, own):
            if first == steps:
                first, began = n, data.xipos[body].copy()
            bearer = bearer_of(model, other)
            turned = data.xmat[bearer].reshape(3, 3).T @ (sign * data.contact.frame[i, :3])
            for one, inside in ((early, n <= first + _EARLY * steps), (late, n >= _LATE * steps)):
                if inside:
                    one.add(bearer, float(force_of(model, data, i)[0]), turned)
    fallen = float((data.xipos[body] - began) @ model.opt.gravity) > _FALLEN * float(np.linalg.norm(model.opt.gravity))
    left = fallen and _apart(model, data, body, early.bodies)
    held = early if (left and early.bodies) or not late.bodies else late
    bearer = max(sorted(held.force), key=lambda one: float(f"{held.force[one]:.6g}"), default=0)
    normal = held.normal.get(bearer, np.zeros(3))
    length = float(np.linalg.norm(normal))
    up = normal / length if length > 0.0 else np.array([0.0, 0.0, 1.0])
    return Watch(body, bearer, held.bodies, up, keyframe, duration)


class _Pressed:
    """What pressed on a body: force : summed, N, and normal : weighed by it, by the other body."""

    def __init__(self) -> None:
        self.force: dict[int, float] = {}
        self.normal: dict[int, FloatArray] = {}

    def add(self, other: int, force: float, normal: FloatArray) -> None:
        if force > 0.0:
            self.force[other] = self.force.get(other, 0.0) + force
            self.normal[other] = self.normal.get(other, np.zeros(3)) + force * normal

    @property
    def bodies(self) -> frozenset[int]:
        """Those that count."""
        whole = sum(self.force.values())
        return frozenset(one for one, force in self.force.items() if force > _HOLDS * whole)


def watched(model: Any, watch: Watch) -> Seen:
    """Step a model under its own options and watch a body."""
    data, h = _started(model, watch.keyframe), float(model.opt.timestep)
    steps = max(8, round(watch.duration / h))
    every, half = max(1, steps // _SAMPLES), steps // 2
    path, turning = np.empty((steps + 1, 3)), np.empty((steps + 1, 3))
    tally = Tally(model, watch.body, watch.bearers)
    diverged, spent = None, np.zeros(steps)
    mujoco.mj_forward(model, data)
    for n in range(steps + 1):
        turn = data.xmat[watch.bearer].reshape(3, 3)
        path[n] = (data.xipos[watch.body] - data.xpos[watch.bearer]) @ turn
        turning[n] = (data.cvel[watch.body, :3] - data.cvel[watch.bearer, :3]) @ turn
        if n % every == 0:
            tally.look(data, n * h, late=n >= half)
        if n == steps:
            break
        began = time.perf_counter()
        mujoco.mj_step(model, data)
        spent[n] = time.perf_counter() - began
        if any(data.warning[kind].number for kind in UNSOUND):
            diverged = n + 1
            path[n + 1 :], turning[n + 1 :] = path[n], 0.0
            break
    ends = diverged is None and bool(watch.bearers) and _apart(model, data, watch.body, watch.bearers)
    return Seen(
        watch,
        h * np.arange(steps + 1, dtype=np.float64),
        path,
        turning,
        tally.slip,
        tally.touched / max(1, tally.looks),
        tally.use,
        tally.strained,
        tally.touches,
        tally.last if ends else None,
        diverged,
        1.0 / float(np.median(spent[: diverged or steps])),  # which nothing else that runs here moves
    )


def _apart(model: Any, data: Any, body: int, others: frozenset[int]) -> bool:
    """Whether a body, with those on it, is away from all of others and what is welded to them."""
    own = geoms_of(model, body)
    fromto = np.zeros(6)
    for other in (g for g in range(model.ngeom) if g not in own and bearer_of(model, g) in others):
        for mine in own:
            if mujoco.mj_geomDistance(model, data, mine, other, _APART, fromto) < _APART:
                return False
    return True


def _started(model: Any, keyframe: int) -> Any:
    data = mujoco.MjData(model)
    if keyframe >= 0:
        mujoco.mj_resetDataKeyframe(model, data, keyframe)
    return data
