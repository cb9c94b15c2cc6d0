"""Runs in MJX: a scan over the steps, compiled once for all sliders, steps and lengths of a structure."""

import logging
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from harness.core.errors import NoDeviceError
from harness.core.kernel_cache import cache_folder
from harness.core.quiet import quiet
from harness.engines.base import Route
from harness.engines.mujoco.at_once import OF_MODEL, Held, Ready, Recorded

log = logging.getLogger("harness.engines.mjx")

with quiet(log):  # it prints what it does without
    import jax
    from jax import numpy as jnp
    from mujoco import mjx

if jax.config.jax_compilation_cache_dir is None:
    jax.config.update("jax_compilation_cache_dir", str(cache_folder() / "jax"))

BLOCK = 256
"""Steps of a scan, whose length is compiled into it: a longer run is several, and what is too much is cut off."""
_OPTIONS = ("timestep", "tolerance", "impratio")
_programs: dict[tuple[Any, ...], Callable[..., Any]] = {}
"""By what is compiled in."""


class Scans:
    """Tasks of one structure, compiled and ready to run at once. sticks : see harness.engines.stepping.Stepped.

    Raises NoDeviceError for a device that is not here.
    """

    def __init__(self, tasks: Sequence[Ready], structure: tuple[Any, ...], sticks: float) -> None:
        (first, self._settings), count = tasks[0], len(tasks)
        self._lengths = [held.push.size for held, _ in tasks]
        blocks = -(-max(self._lengths) // BLOCK)
        pushes = np.zeros((count, blocks * BLOCK))
        for row, (held, _) in zip(pushes, tasks, strict=True):
            row[: held.push.size] = held.push
        with self._there() as device, quiet(log):
            stacked = [np.stack(one) for one in zip(*(jax.tree.leaves(_numbers(*task)) for task in tasks), strict=True)]
            shape = jax.tree.structure(_numbers(*tasks[0]))
            self._numbers, self._state = jax.tree.unflatten(shape, map(jnp.asarray, stacked))
            self._parts = [jnp.asarray(part) for part in np.split(pushes, blocks, axis=1)]
            compiled_in = (*structure, count)
            if compiled_in not in _programs:
                made = _program(mjx.put_model(first.model, device), first, self._settings, count, sticks)
                given = (self._numbers, self._state, self._parts[0])
                _programs[compiled_in] = jax.jit(made).lower(*given).compile()
            self._program = _programs[compiled_in]

    def run(self) -> list[Recorded]:
        """What each recorded."""
        found, state = [], self._state
        with self._there():
            for part in self._parts:
                state, out = self._program(self._numbers, state, part)
                found.append(out)
            arrays = np.concatenate([np.asarray(out, dtype=np.float64) for out in found], axis=-1)
        return [Recorded(*one[:, :length]) for one, length in zip(arrays, self._lengths, strict=True)]

    @contextmanager
    def _there(self) -> Iterator[Any]:
        """On the device and in the precision of the settings."""
        name = self._settings["device"]
        try:
            device = jax.devices(name)[0]
        except RuntimeError:
            raise NoDeviceError(f"mjx: no {name} that jax can use") from None
        with jax.enable_x64(self._settings["precision"] == 64), jax.default_device(device):
            yield device


def _numbers(held: Held, settings: dict[str, Any]) -> tuple[dict[str, Any], tuple[Any, ...]]:
    """What a program is given besides its structure, and the state at the start."""
    model = held.model
    numbers: dict[str, Any] = {name: np.array(value) for name, value in held.numbers(settings).items()}
    numbers["model"] = {name: np.array(getattr(model, name)) for name in OF_MODEL}
    numbers["options"] = {name: np.array(getattr(model.opt, name)) for name in _OPTIONS}
    return numbers, (held.q, held.speed, np.zeros(model.nv), np.array(held.stuck))


def _program(mx: Any, first: Held, settings: dict[str, Any], count: int, sticks: float) -> Callable[..., Any]:
    """From numbers, state and pushes (count, BLOCK) to state and records (count, 7, BLOCK), see Recorded."""
    route: Route = first.task.route
    stages, rubs = settings["integrator"] == "RK4", first.rubs
    empty = mjx.make_data(mx)
    zero, nowhere = jnp.zeros(()), jnp.zeros(mx.nv)

    def limited(m: Any, limit: Any, weight: Any) -> Any:
        """The model with this limit of friction."""
        if rubs:
            return m.replace(dof_frictionloss=m.dof_frictionloss.at[0].set(limit))
        if route == "contact":
            return m.replace(pair_friction=m.pair_friction.at[0, :2].set(limit / weight))
        return m

    def one(numbers: dict[str, Any], state: tuple[Any, ...], pushes: Any) -> Any:
        model = mx.replace(**numbers["model"], opt=mx.opt.replace(**numbers["options"]))
        weight = numbers["weight"]

        def step(carried: Any, push: Any) -> Any:
            d, stuck = carried
            q, speed = d.qpos, d.qvel
            u, falling = speed[0], numbers["falling"]
            falls = numbers["f_k"] + (numbers["f_s"] - numbers["f_k"]) * jnp.exp(-((falling * u) ** 2))
            limit = jnp.where(falling > 0.0, falls, jnp.where(stuck, numbers["f_s"], numbers["f_k"]))
            push = push - u * jnp.abs(u) * (numbers["c_2"] + numbers["c_3"] * jnp.abs(u))
            m = limited(model, limit, weight)
            friction = zero
            if route == "law":
                others = push - numbers["spring"] * q[0] - numbers["damper"] * u
                friction = jnp.clip(numbers["metric"] * u + others, -limit, limit)
            d = d.replace(qfrc_applied=nowhere.at[0].set(push - friction))
            # after the stages data are those of the last one
            before = d
            d = mjx.step(m, d)
            seen = mjx.forward(m, before) if stages else d
            if route != "law":
                friction = -seen.qfrc_constraint[0]
            normal = seen.qfrc_constraint[1] if route == "contact" else weight
            height = q[1] if route == "contact" else zero
            stuck = jnp.abs(friction) < sticks * limit * normal / weight
            return (d, stuck), jnp.stack([q[0], u, seen.qacc[0], friction, limit, height, normal])

        q, speed, warm, stuck = state
        begun = empty.replace(qpos=q, qvel=speed, qacc_warmstart=warm)
        (d, stuck), records = jax.lax.scan(step, (begun, stuck), pushes)
        return (d.qpos, d.qvel, d.qacc_warmstart, stuck), records.T

    if count > 1:
        return jax.vmap(one)  # type: ignore[no-any-return]

    def alone(*given: Any) -> Any:
        # a batch of one would take both ways at every branch
        return jax.tree.map(lambda array: array[None], one(*jax.tree.map(lambda array: array[0], given)))

    return alone
