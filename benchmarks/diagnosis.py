"""The whole diagnosis against a fit of three numbers by mujoco.sysid, and its cost against the length."""

import importlib
import io
from contextlib import redirect_stdout
from functools import partial
from typing import Any

import mujoco
import numpy as np

from benchmarks.registry import Pair, benchmark
from harness.api import diagnose
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.kernels.solve import solve
from harness.model.model import Model, ModelTerm

sysid: Any = importlib.import_module("mujoco.sysid")

_SAMPLES = 5000
_DT = 0.002
_M, _C, _K, _F_K, _X0 = 1.0, 0.12, 40.0, 0.06, 0.1
_NOISE = 2e-3
_OFF = 1.2

_XML = f"""
<mujoco>
  <option timestep="{_DT}"><flag contact="disable"/></option>
  <worldbody>
    <body>
      <inertial pos="0 0 0" mass="{_M}" diaginertia="1 1 1"/>
      <joint name="slide" type="slide" axis="1 0 0"/>
      <geom type="sphere" size="0.01"/>
    </body>
  </worldbody>
  <actuator><motor name="push" joint="slide"/></actuator>
  <sensor><jointpos name="x" joint="slide"/></sensor>
</mujoco>
"""


def _recording(samples: int, dt: float) -> Recording:
    """A decay with quadratic drag left out, x and a with white noise."""
    t: FloatArray = np.arange(samples, dtype=np.float64) * dt
    drag = ModelTerm.named("quadratic-drag", c2=1.5)
    model = Model(m=_M, c=_C, k=_K, f_k=_F_K, x0=_X0, terms=(drag,))
    run = solve(model, t)
    random = np.random.default_rng(1)
    x = run.x + _NOISE * _X0 * random.standard_normal(samples)
    a = run.a + 3.0 * _NOISE * _X0 * _K / _M * random.standard_normal(samples)
    return Recording(t=t, channels={"x": x, "a": a})


class _SystemIdentification:
    """mujoco.sysid with its defaults: stiffness, damping and frictionloss fitted to x from starts 20 % off."""

    def __init__(self, recording: Recording) -> None:
        self._spec = mujoco.MjSpec.from_string(_XML)
        start = mujoco.MjData(self._spec.compile())
        first = sysid.create_initial_state(self._spec.compile(), np.array([_X0]), start.qvel, start.act)
        x = recording.channels["x"][:, None]
        control = sysid.TimeSeries(recording.t, np.zeros_like(x))
        sensor = sysid.TimeSeries.from_names(recording.t, x, self._spec.compile())
        self._sequences = sysid.ModelSequences("slider", self._spec, "decay", first, control, sensor)

    def fit(self) -> Any:
        """The fitted numbers."""
        parameters = sysid.ParameterDict()
        for name, value in (("stiffness", _K), ("damping", _C), ("frictionloss", _F_K)):
            parameters.add(
                sysid.Parameter(
                    name,
                    nominal=_OFF * value,
                    min_value=0.0,
                    max_value=10.0 * value,
                    modifier=partial(_set, name),
                )
            )
        residual = sysid.build_residual_fn(models_sequences=[self._sequences])
        with redirect_stdout(io.StringIO()):  # it prints its iterations even so
            return sysid.optimize(initial_params=parameters, residual_fn=residual, verbose=False)[0]


def _set(name: str, spec: mujoco.MjSpec, parameter: Any) -> None:
    joint, value = spec.joint("slide"), float(parameter.value[0])
    old = getattr(joint, name)
    setattr(joint, name, value if np.ndim(old) == 0 else [value, *np.asarray(old)[1:]])


@benchmark(
    "diagnosis.whole",
    peer="mujoco.sysid: stiffness, damping and frictionloss fitted to x, its defaults, starts 20 % off",
    timed="diagnosis of 5000 samples of x and a, quadratic drag left out; all entries, both engines, nothing written",
    target=10.0,
)
def whole() -> Pair:
    recording = _recording(_SAMPLES, _DT)
    peer = _SystemIdentification(recording)
    diagnose(recording)
    peer.fit()
    return Pair(lambda: diagnose(recording), peer.fit, rounds=3)


@benchmark(
    "diagnosis.length",
    peer="the same with a tenth of the samples (1e4)",
    timed="diagnosis of 1e5 samples of the same ten seconds: linear cost gives 10",
    target=12.0,
)
def length() -> Pair:
    long, short = _recording(100_000, 1e-4), _recording(10_000, 1e-3)
    diagnose(_recording(1000, 1e-2))
    return Pair(lambda: diagnose(long), lambda: diagnose(short), rounds=1)
