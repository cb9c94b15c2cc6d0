"""mujoco.sysid: stiffness, damping and frictionloss of a joint fitted to position; it names nothing, it predicts.

mujoco[sysid] is an optional extra. It is served well: starting values come from the decrement, the start of the motion
is fitted too (by its custom rollout), and the step adds no error to speak of: Euler read as a leapfrog, friction
as stiff as the step allows.
"""

import math
from collections.abc import Mapping, Sequence
from contextlib import redirect_stdout
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from io import StringIO
from typing import Any

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import SimulationError
from harness.proof.baselines.regression import Recording, period_of, refusal
from harness.proof.plant.cases import decrement

STEP = 0.01
"""Longest step times the frequency."""
START = 0.15
"""Length of the stretch from which the start is read, periods."""
FIRST_ZETA, FIRST_X_K = 0.02, 0.02
"""Starting values where the decrement has no plausible ones, the latter of the largest position."""

XML = """
<mujoco>
  <option timestep="{dt!r}" integrator="Euler" gravity="0 0 0"><flag contact="disable"/></option>
  <worldbody>
    <body>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <joint name="slide" type="slide" axis="1 0 0" solreffriction="{two!r} 1" solimpfriction=".9999 .9999 .001"/>
      <geom type="sphere" size="0.01"/>
    </body>
  </worldbody>
  <actuator><motor name="push" joint="slide"/></actuator>
  <sensor><jointpos name="x" joint="slide"/></sensor>
</mujoco>
"""


@dataclass(frozen=True, slots=True)
class HeldOut:
    """Held-out rmse by channel (position alone); ``applies`` is false, with the reason, where nothing can be fitted.

    parameters : stiffness (1/s^2, per unit mass), damping (1/s), frictionloss (m/s^2).
    """

    rmse: Mapping[str, float]
    applies: bool = True
    why: str = ""
    parameters: Mapping[str, float] | None = None


def holdout_by_sysid(recording: Recording, spans_s: Sequence[Sequence[float]]) -> HeldOut:
    """Fit what lies outside the spans (s) and predict what lies within; spans as a verdict's holdout gives them.

    Raises SimulationError when mujoco[sysid] is not installed.
    """
    why = refusal(recording)
    if why:
        return HeldOut({}, False, why)
    mujoco, sysid = _packages()
    t, x = recording["t"] - recording["t"][0], recording["x"]
    spans = [(low - recording["t"][0], high - recording["t"][0]) for low, high in spans_s]
    out = held_out(t, spans)
    period = period_of(t, x)
    if not math.isfinite(period) or not np.any(out):
        return HeldOut({}, False, "no oscillation" if not math.isfinite(period) else "nothing was held out")
    omega, length = 2.0 * math.pi / period, float(np.max(np.abs(x)))
    sample = float(t[1] - t[0])
    dt = sample / math.ceil(sample * omega / STEP)
    spec = mujoco.MjSpec.from_string(XML.format(dt=dt, two=2.0 * dt))
    x0, v0 = start_of(t, x, period)
    model = spec.compile()

    def state(x_start: float, v_start: float) -> FloatArray:
        # the speed that a leapfrog begins with is that of half a step earlier
        early = v_start + 0.5 * dt * omega**2 * x_start
        return np.asarray(sysid.create_initial_state(model, np.array([x_start]), np.array([early]), np.empty(0)))

    # one sample more: a rollout ends a step early
    times = np.append(t, t[-1] + sample)
    seen = np.append(x, x[-1])[:, None]
    sequences = sysid.ModelSequences(
        "slider", spec, "decay", state(x0, v0),
        sysid.TimeSeries(times, np.zeros_like(seen)), sysid.TimeSeries.from_names(times, seen, model),
    )  # fmt: skip
    predicted: list[FloatArray] = []

    def residual(_: Any, said: Any, measured: Any, *rest: Any, **more: Any) -> Any:
        at = np.interp(t, np.asarray(said.times), np.asarray(said.data)[:, 0])
        predicted[:] = [at]
        return (at - x)[~out][:, None] / length, said, measured

    def rollout(*, param_dicts: Sequence[Any], initial_states: Any, **more: Any) -> Any:
        starts = [state(float(p["x0"].value[0]) * length, float(p["v0"].value[0]) * speed) for p in param_dicts]
        return sysid.sysid_rollout(initial_states=starts, **more)

    speed = omega * length
    parameters = sysid.ParameterDict()
    for name, value in (("x0", x0 / length), ("v0", v0 / speed)):
        parameters.add(sysid.Parameter(name, nominal=value, min_value=value - 0.3, max_value=value + 0.3))
    seems = decrement(t, x, "x")
    zeta, x_k = (seems.zeta, seems.x_k) if seems.plausible(omega, length) else (FIRST_ZETA, FIRST_X_K * length)
    guess = {"stiffness": omega**2, "damping": 2.0 * zeta * omega, "frictionloss": x_k * omega**2}
    for name, value in guess.items():
        low, high = (0.5, 2.0) if name == "stiffness" else (0.0, 20.0)
        parameters.add(
            sysid.Parameter(
                name, nominal=value, min_value=low * value, max_value=high * value, modifier=partial(_set, name)
            )
        )
    wanted = sysid.build_residual_fn(models_sequences=[sequences], modify_residual=residual, custom_rollout=rollout)
    with redirect_stdout(StringIO()):
        # its optimiser prints every iteration
        best = sysid.optimize(initial_params=parameters, residual_fn=wanted, verbose=False)[0]
    wanted(best.as_vector(), best)
    rmse = float(np.sqrt(np.mean((predicted[0] - x)[out] ** 2)))
    return HeldOut({"x": rmse}, parameters={name: float(best[name].value[0]) for name in guess})


def _packages() -> tuple[Any, Any]:
    """mujoco and mujoco.sysid, whose names are all there only with the extra."""
    try:
        mujoco, sysid = import_module("mujoco"), import_module("mujoco.sysid")
        vars(sysid)["optimize"]
    except (ImportError, KeyError):
        raise SimulationError("mujoco.sysid is not installed: pip install mujoco[sysid]") from None
    return mujoco, sysid


def held_out(t: FloatArray, spans_s: Sequence[Sequence[float]]) -> BoolArray:
    """Which samples lie in the spans, shape (n,); an end belongs to the next span."""
    out = np.zeros(t.size, dtype=bool)
    for low, high in spans_s:
        out |= (t >= low) & (t < high)
    return out


def start_of(t: FloatArray, x: FloatArray, period: float) -> tuple[float, float]:
    """Position (m) and speed (m/s) at the start, from a cubic through the first samples."""
    n = max(6, int(np.searchsorted(t, START * period)))
    speed, start = np.polynomial.polynomial.polyfit(t[:n], x[:n], 3)[1::-1]
    return float(start), float(speed)


def _set(name: str, spec: Any, parameter: Any) -> None:
    joint, value = spec.joint("slide"), float(parameter.value[0])
    old = getattr(joint, name)
    setattr(joint, name, value if np.ndim(old) == 0 else [value, *np.asarray(old)[1:]])
