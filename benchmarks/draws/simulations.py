"""A recording of a slider with noise, beside a simulation of the same slider by MuJoCo with settings as they come."""

import math
from functools import partial

import numpy as np

import harness
from benchmarks.draws.shared import Answer, log_uniform
from harness.core.errors import HarnessError
from harness.core.recording import Recording
from harness.proof.paths.simulated import Settings, stepped

_OF_MODEL = {"k": "k", "c": "c", "f": "f_k"}


def drawn(seed: int, number: int, *, wrong: bool) -> tuple[Recording, Recording, str]:
    """A recording, a simulation's trace, and which parameter of the simulation is wrong ("" for none)."""
    r = np.random.default_rng([seed, number])
    log = partial(log_uniform, r)
    m, w, x0 = r.uniform(0.4, 3.0), r.uniform(5.0, 25.0), r.uniform(0.02, 0.1)
    k, period = m * w * w, 2.0 * math.pi / w
    own = {"k": k, "c": 2.0 * log(0.005, 0.05) * w * m, "f": x0 * log(0.004, 0.03) * k}
    settings = Settings.drawn(r, period)
    name = str(r.choice(list(own))) if wrong else ""
    by = r.uniform(0.01, 0.05) if name == "k" else r.uniform(0.1, 0.5)
    used = own | ({name: own[name] * (1.0 + float(r.choice([-1.0, 1.0])) * by)} if name else {})
    cycles = r.uniform(9.0, 20.0)
    model = settings.model(m, **{_OF_MODEL[key]: value for key, value in used.items()})
    trace = stepped(model, x0, int(cycles * period / settings.dt))
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
