"""A simulation of the user's own beside a recording: a program of a few lines, or MuJoCo with settings as they come."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.proof.paths.forms import Rng, _between

NUMBERS = ("c", "k", "f_k")
"""Of a simulation, in the order of a rig's."""
_XML = """<mujoco><option timestep="{dt}" gravity="0 0 0" integrator="{integrator}"/><worldbody><body>
<joint name="s" type="slide" axis="1 0 0" stiffness="{k}" damping="{c}" frictionloss="{f_k}" {soft}/>
<geom type="box" size=".05 .05 .05" mass="{m}"/></body></worldbody></mujoco>
"""


@dataclass(frozen=True, slots=True)
class Settings:
    """Of MuJoCo: step, s, integrator, and what a joint says of its friction."""

    dt: float
    integrator: str
    soft: str

    @classmethod
    def drawn(cls, rng: Rng, period: float) -> "Settings":
        """As they come; of at least sixty steps a period (s)."""
        dt = float(rng.choice([0.0005, 0.001, 0.002, 0.002, 0.002, 0.003, 0.004]))
        while dt > period / 60.0:
            dt /= 2.0
        soft = [
            "",
            "",
            f'solreffriction="{rng.uniform(0.008, 0.05):.4f} 1"',
            f'solimpfriction="{rng.uniform(0.8, 0.99):.3f} .99 .001 .5 2"',
            f'solreffriction="{max(2.2 * dt, 0.004):.4f} 1"',
        ]
        integrator = str(rng.choice(["Euler", "Euler", "implicitfast", "implicit", "RK4"]))
        return cls(dt, integrator, str(rng.choice(soft)))

    def model(self, m: float, **numbers: float) -> str:
        """MJCF of a slider, SI; numbers : ``NUMBERS``."""
        return _XML.format(dt=self.dt, integrator=self.integrator, soft=self.soft, m=m, **numbers)


def stepped(model: str, x0: float, n: int) -> FloatArray:
    """t, x, v, a (n, 4) of a slider let go from x0, m, by MuJoCo."""
    import mujoco

    own: Any = mujoco.MjModel.from_xml_string(model)
    data = mujoco.MjData(own)
    data.qpos[0] = x0
    rows = np.empty((n, 4))
    for row in rows:
        mujoco.mj_forward(own, data)
        row[:] = data.time, data.qpos[0], data.qvel[0], data.qacc[0]
        mujoco.mj_step(own, data)
    return rows


def programmed(x0: float, dt: float, n: int, every: int, c: float, k: float, f_k: float) -> FloatArray:
    """t, x, v, a (n, 4) of 1 kg let go from x0, by steps of dt (s) as somebody writes them: speed first, then place."""
    rows, x, v = np.empty((n, 4)), x0, 0.0
    for step in range(n * every):
        pull = -(k * x + c * v)
        held = v == 0.0 and abs(pull) <= f_k
        a = 0.0 if held else pull - math.copysign(f_k, v if v != 0.0 else pull)
        if step % every == 0:
            rows[step // every] = step * dt, x, v, a
        faster = v + dt * a
        v = 0.0 if v * faster < 0.0 and abs(k * x) <= f_k else faster
        x += dt * v
    return rows


def beside(
    rng: Rng, b: FloatArray, x0: float, seconds: float, noise: float
) -> tuple[dict[str, str], list[str], list[str]]:
    """The user's simulation by the name of its file, the options, and which of its numbers is wrong, one or none.

    b : m, c, k, f_k that are true. noise : of x over x0.
    """
    period = 2.0 * math.pi * math.sqrt(b[0] / b[2])
    numbers = dict(zip(NUMBERS, map(float, b[1:4]), strict=True))
    wrong = [str(rng.choice(NUMBERS))] if rng.random() < 0.5 else []
    for name in wrong:
        by = max(_between(rng, 0.01, 0.05), 3.0 * noise) if name == "k" else max(_between(rng, 0.1, 0.5), 10.0 * noise)
        numbers[name] *= 1.0 + float(rng.choice([-1.0, 1.0])) * by
    way = int(rng.integers(3))
    if way == 0:
        every = int(rng.integers(8, 40))
        rows = programmed(x0, period / 100.0 / every, int(100.0 * seconds / period), every, **numbers)
    else:
        settings, m = Settings.drawn(rng, period), _between(rng, 0.3, 3.0)
        model = settings.model(m, **{name: value * m / float(b[0]) for name, value in numbers.items()})
        if way == 2:
            return {"slider.xml": model}, ["--model", "slider.xml"], wrong
        rows = stepped(model, x0, int(seconds / settings.dt))
    shown = str(rng.choice(["x", "xv", "xva", "xa"]))
    heads = {"x": "x [m]", "v": "v [m/s]", "a": "a [m/s^2]"}
    lines = [",".join(["t [s]", *(heads[c] for c in shown)])]
    at = [0, *(1 + "xva".index(c) for c in shown)]
    lines += [",".join(f"{one:.9g}" for one in row[at]) for row in rows]
    return {"simulation.csv": "\n".join(lines) + "\n"}, ["--sim", "simulation.csv"], wrong
