"""Friction curves as test benches publish them, of seven laws, each in the formula of its trade and none of ours."""

import numpy as np

import harness
from benchmarks.draws.shared import Answer, log_uniform
from harness.core.arrays import FloatArray
from harness.core.errors import HarnessError
from harness.core.recording import Recording

LAWS = ("", "stribeck", "lorentzian", "power-law-damping", "quadratic-drag", "constant-force", "asymmetric-viscous")
"""The second falls as a Gaussian, the third as one over a square: both are Stribeck."""


def drawn(seed: int, number: int) -> tuple[Recording, str]:
    """A table and the name of what is in it besides viscous and Coulomb friction."""
    r = np.random.default_rng([seed, number])
    law = LAWS[number % len(LAWS)]
    rows, top = int(r.integers(10, 26)), log_uniform(r, 0.05, 300.0)
    both = law in ("constant-force", "asymmetric-viscous") or r.random() < 0.7
    spaced = np.geomspace(0.005 * top, top, rows) if r.random() < 0.6 else np.linspace(0.03 * top, top, rows)
    v: FloatArray = np.concatenate((-spaced[::-1], spaced)) if both else spaced
    level = log_uniform(r, 0.01, 100.0)
    s, side = np.abs(v) / top, np.sign(v)
    size, knee = r.uniform(0.25, 0.9), r.uniform(0.08, 0.25)
    f = 1.0 + r.uniform(0.2, 1.0) * s
    if law == "stribeck":
        f = f + size * np.exp(-((s / knee) ** 2))
    elif law == "lorentzian":
        f = f + size / (1.0 + (s / knee) ** 2)
    elif law == "power-law-damping":
        f = f + 2.0 * size * s ** r.uniform(0.3, 0.6)
    elif law == "quadratic-drag":
        f = f + size * s**2
    elif law == "asymmetric-viscous":
        f = f + 0.5 * size * s * side
    u = level * (side * f + (0.3 * size if law == "constant-force" else 0.0))
    u = u + level * 10.0 ** r.uniform(-3.0, -2.0) * r.standard_normal(u.size)
    mixed = r.permutation(u.size)
    told = Recording(np.arange(u.size, dtype=np.float64), {"v": v[mixed], "u": u[mixed]}, "table.csv", steady=True)
    return told, "stribeck" if law == "lorentzian" else law


def answer(seed: int, number: int) -> Answer:
    """Right where the law is named alone, or listed with two others at most."""
    table, law = drawn(seed, number)
    try:
        found = harness.diagnose(table, engines=())
    except HarnessError as error:
        return Answer(False, f"{law}: {error}")
    names = [m.name for m in found.mechanisms]
    listed = found.verdict == "one_of" and law in names and len(names) <= 3
    right = names == [law] or listed if law else found.verdict == "adequate"
    return Answer(right, f"{law or 'nothing'}: {found.verdict} {names}")
