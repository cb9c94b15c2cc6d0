"""Runs in MuJoCo Warp: one world a task, the calls of a step recorded once as a graph and launched step by step."""

import logging
from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from harness.core.errors import NoDeviceError
from harness.core.kernel_cache import cache_folder
from harness.core.quiet import quiet
from harness.engines.mujoco.at_once import OF_MODEL, Ready, Recorded

log = logging.getLogger("harness.engines.warp")

with quiet(log):  # it says what it finds
    import mujoco_warp as mjw
    import warp as wp

    if wp.config.kernel_cache_dir is None:
        wp.config.kernel_cache_dir = str(cache_folder() / "warp")
    wp.init()

_CONTACTS, _ROWS = 8, 32
"""Contacts and rows of constraints of a world, at most."""
_F_K, _F_S, _WEIGHT, _SPRING, _DAMPER, _METRIC, _FALLING, _C_2, _C_3 = (wp.constant(i) for i in range(9))
_Q, _SPEED, _A, _FRICTION, _LIMIT, _HEIGHT, _NORMAL = (wp.constant(i) for i in range(7))
_CONTACT, _LAW = (wp.constant(i) for i in (1, 2))
_ROUTES = {"joint": 0, "contact": 1, "law": 2}


def _push(
    route: int,
    rubs: int,
    moment: wp.array[int],
    pushes: wp.array2d[float],
    numbers: wp.array2d[float],
    stuck: wp.array[int],
    qpos: wp.array2d[float],
    qvel: wp.array2d[float],
    applied: wp.array2d[float],
    frictionloss: wp.array2d[float],
    pair_friction: wp.array2d[Any],
    records: wp.array3d[float],
) -> None:
    """Before a step: push each world and limit its friction."""
    world = wp.tid()
    step = moment[0]
    q = qpos[world, 0]
    speed = qvel[world, 0]
    limit = numbers[world, _F_K]
    falling = numbers[world, _FALLING]
    if falling > 0.0:
        limit += (numbers[world, _F_S] - limit) * wp.exp(-falling * speed * falling * speed)
    elif stuck[world] != 0:
        limit = numbers[world, _F_S]
    push = pushes[world, step] - speed * wp.abs(speed) * (numbers[world, _C_2] + numbers[world, _C_3] * wp.abs(speed))
    if rubs != 0:
        frictionloss[world, 0] = limit
    if route == _CONTACT:
        found = pair_friction[world, 0]
        found[0] = limit / numbers[world, _WEIGHT]
        found[1] = limit / numbers[world, _WEIGHT]
        pair_friction[world, 0] = found
        records[world, _HEIGHT, step] = qpos[world, 1]
    if route == _LAW:
        others = push - numbers[world, _SPRING] * q - numbers[world, _DAMPER] * speed
        friction = wp.clamp(numbers[world, _METRIC] * speed + others, -limit, limit)
        records[world, _FRICTION, step] = friction
        push -= friction
    applied[world, 0] = push
    records[world, _Q, step] = q
    records[world, _SPEED, step] = speed
    records[world, _LIMIT, step] = limit


def _look(
    route: int,
    sticks: float,
    moment: wp.array[int],
    numbers: wp.array2d[float],
    qacc: wp.array2d[float],
    rows: wp.array[int],
    jacobian: wp.array3d[float],
    forces: wp.array2d[float],
    stuck: wp.array[int],
    records: wp.array3d[float],
) -> None:
    """After the forces of a step are known: those of the constraints, which keep to their cones.

    qfrc_constraint lags behind them, by 0.3 % in the step in which a box lands.
    """
    world = wp.tid()
    step = moment[0]
    share = float(1.0)  # noqa: UP018  (a variable of a kernel, not a constant)
    if route != _LAW:
        along = float(0.0)  # noqa: UP018
        up = float(0.0)  # noqa: UP018
        for row in range(rows[world]):
            along += jacobian[world, row, 0] * forces[world, row]
            if route == _CONTACT:
                up += jacobian[world, row, 1] * forces[world, row]
        records[world, _FRICTION, step] = -along
        if route == _CONTACT:
            records[world, _NORMAL, step] = up
            share = up / numbers[world, _WEIGHT]
    records[world, _A, step] = qacc[world, 0]
    stuck[world] = 0
    if wp.abs(records[world, _FRICTION, step]) < sticks * records[world, _LIMIT, step] * share:
        stuck[world] = 1


def _next(moment: wp.array[int]) -> None:
    moment[0] = moment[0] + 1


with quiet(log):
    push_kernel, look_kernel, next_kernel = (wp.kernel(one) for one in (_push, _look, _next))


class Worlds:
    """Tasks that are alike, ready to run at once. sticks : see harness.engines.stepping.Stepped.

    Raises NoDeviceError for a device that is not here.
    """

    def __init__(self, tasks: Sequence[Ready], sticks: float) -> None:
        (first, settings), self._count = tasks[0], len(tasks)
        self._lengths = [held.push.size for held, _ in tasks]
        self._device = _device(settings["device"])
        pushes = np.zeros((self._count, max(self._lengths)))
        for row, (held, _) in zip(pushes, tasks, strict=True):
            row[: held.push.size] = held.push
        with quiet(log), wp.ScopedDevice(self._device):
            self._model = m = mjw.put_model(first.model)
            m.opt.warn_overflow = 0  # or each step prints that iterations are few
            for name in OF_MODEL:
                values = np.stack([getattr(held.model, name) for held, _ in tasks])
                if values.size:
                    setattr(m, name, wp.array(values, dtype=getattr(m, name).dtype))
            there = mujoco.MjData(first.model)
            self._data = mjw.put_data(first.model, there, nworld=self._count, nconmax=_CONTACTS, njmax=_ROWS)
            self._starts = [np.stack([getattr(held, name) for held, _ in tasks]) for name in ("q", "speed")]
            self._held = np.array([held.stuck for held, _ in tasks], dtype=np.int32)
            numbers = np.array([list(held.numbers(one).values()) for held, one in tasks])
            self._pushes, self._numbers = (wp.array(each, dtype=float) for each in (pushes, numbers))
            self._moment, self._stuck = wp.zeros(1, dtype=int), wp.zeros(self._count, dtype=int)
            self._records = wp.zeros((self._count, 7, max(self._lengths)), dtype=float)
            self._route, self._rubs = _ROUTES[first.task.route], int(first.rubs)
            self._sticks, self._stages = sticks, settings["integrator"] == "RK4"
            self._step()  # what is compiled is compiled here
            with wp.ScopedCapture() as captured:
                self._step()
            self._graph = captured.graph

    def _step(self) -> None:
        d, m = self._data, self._model
        given = [self._moment, self._pushes, self._numbers, self._stuck, d.qpos, d.qvel, d.qfrc_applied]
        changed = [m.dof_frictionloss, m.pair_friction, self._records]
        wp.launch(push_kernel, dim=self._count, inputs=[self._route, self._rubs, *given, *changed])
        if self._stages:  # after the stages data are those of the last one
            mjw.forward(m, d)
            self._look()
        mjw.step(m, d)
        if not self._stages:
            self._look()
        wp.launch(next_kernel, dim=1, inputs=[self._moment])

    def _look(self) -> None:
        d = self._data
        seen = [self._moment, self._numbers, d.qacc, d.nefc, d.efc.J, d.efc.force, self._stuck, self._records]
        wp.launch(look_kernel, dim=self._count, inputs=[self._route, self._sticks, *seen])

    def run(self) -> list[Recorded]:
        """What each recorded."""
        d = self._data
        with wp.ScopedDevice(self._device):
            for array in (self._moment, d.time, d.qacc_warmstart):
                array.zero_()
            for array, start in ((d.qpos, self._starts[0]), (d.qvel, self._starts[1]), (self._stuck, self._held)):
                array.assign(start)
            for _ in range(max(self._lengths)):
                wp.capture_launch(self._graph)
            records = self._records.numpy().astype(np.float64)
        return [Recorded(*one[:, :length]) for one, length in zip(records, self._lengths, strict=True)]


def _device(name: str) -> Any:
    """Raises NoDeviceError where there is none."""
    found = "cpu" if name == "cpu" else next((one for one in wp.get_devices() if one.is_cuda), None)
    if found is None:
        raise NoDeviceError(f"warp: no {name} that warp can use")
    return found
