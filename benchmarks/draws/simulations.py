"""A recording of a slider with noise, beside a simulation of the same slider by MuJoCo with settings as they come."""

import math
from functools import partial
from typing import Any

import numpy as np

import harness
from benchmarks.draws.shared import Answer, log_uniform
from harness.core.errors import HarnessError
from harness.core.recording import Recording

_XML = """<mujoco><option timestep="{dt}" gravity="0 0 0" integrator="{integrator}"/><worldbody><body>
<joint name="s" type="slide" axis="1 0 0" stiffness="{k}" damping="{c}" frictionloss="{f}" {soft}/>
<geom type="box" size=".05 .05 .05" mass="{m}"/></body></worldbody></mujoco>"""
_OF_MODEL = {"k": "k", "c": "c", "f": "f_k"}


def drawn(seed: int, number: int, *, wrong: bool) -> tuple[Recording, Recording, str]:
    """A recording, a simulation's trace, and which parameter of the simulation is wrong ("" for none)."""
    import mujoco

    r = np.random.default_rng([seed, number])
    log = partial(log_uniform, r)
    m, w, x0 = r.uniform(0.4, 3.0), r.uniform(5.0, 25.0), r.uniform(0.02, 0.1)
    k, period = m * w * w, 2.0 * math.pi / w
    own = {"k": k, "c": 2.0 * log(0.005, 0.05) * w * m, "f": x0 * log(0.004, 0.03) * k}
    dt = float(r.choice([0.0005, 0.001, 0.002, 0.002, 0.002, 0.003, 0.004]))
    while dt > period / 60.0:
        dt /= 2.0
    integrator = str(r.choice(["Euler", "Euler", "implicitfast", "implicit", "RK4"]))
    soft = [
        "",
        "",
        f'solreffriction="{r.uniform(0.008, 0.05):.4f} 1"',
        f'solimpfriction="{r.uniform(0.8, 0.99):.3f} .99 .001 .5 2"',
        f'solreffriction="{max(2.2 * dt, 0.004):.4f} 1"',
    ]
    name = str(r.choice(list(own))) if wrong else ""
    by = r.uniform(0.01, 0.05) if name == "k" else r.uniform(0.1, 0.5)
    used = own | ({name: own[name] * (1.0 + float(r.choice([-1.0, 1.0])) * by)} if name else {})
    xml = _XML.format(dt=dt, integrator=integrator, m=m, soft=str(r.choice(soft)), **used)
    cycles = r.uniform(9.0, 20.0)
    trace = _stepped(mujoco, xml, x0, int(cycles * period / dt))
    shown = [("x",), ("x", "v"), ("x", "v", "a"), ("x", "a")][int(r.integers(4))]
    every = int(r.choice([1, 1, 2]))
    columns = {c: trace[::every, 1 + "xva".index(c)] for c in shown}
    sim = Recording(np.round(trace[::every, 0], 9), columns, "simulation.csv")
    t = np.arange(0.0, cycles * period * r.uniform(0.8, 1.0), period / r.uniform(60.0, 200.0))
    real = harness.simulate(harness.Model(m, own["c"], k, own["f"], x0=x0), t)
    level = 10.0 ** r.uniform(-3.5, -2.3)
    seen = [("x",), ("x",), ("x", "a")][int(r.integers(3))]
    size = {"x": x0, "a": x0 * w * w}
    noisy = {c: getattr(real, c) + level * size[c] * r.standard_normal(t.size) for c in seen}
    return Recording(t, noisy, "recording.csv"), sim, name


def _stepped(mujoco: Any, xml: str, x0: float, n: int) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """t, x, v, a (n, 4)."""
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    data.qpos[0] = x0
    rows = np.empty((n, 4))
    for row in rows:
        mujoco.mj_forward(model, data)
        row[:] = data.time, data.qpos[0], data.qvel[0], data.qacc[0]
        mujoco.mj_step(model, data)
    return rows


def answer(seed: int, number: int, *, wrong: bool) -> Answer:
    """Right where no parameter and no term is to be changed; where one parameter is wrong, that one alone."""
    recording, sim, name = drawn(seed, number, wrong=wrong)
    try:
        found = harness.diagnose(recording, sim=sim, engines=())
    except HarnessError as error:
        return Answer(False, f"{name or 'right'}: {error}")
    told = None if found.attribution is None else found.attribution.changes
    changes = [one.name for one in told or () if one.kind in ("parameter", "term")]
    right = told is not None and found.verdict == "adequate" and changes == ([_OF_MODEL[name]] if name else [])
    return Answer(right, f"{name or 'right'}: {found.verdict}, to change {changes}")
