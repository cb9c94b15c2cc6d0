"""A simulation that swings faster than its recording, a clock that drifts, and what estimators miss silently."""

import math

import numpy as np

import harness
from benchmarks.draws.faults import decay
from benchmarks.draws.shared import Answer, log_uniform
from harness.core.errors import HarnessError, InputError
from harness.core.recording import Recording
from harness.estimate.every import estimate_all
from harness.model.model import Model, ModelTerm

_SILENT = 1e-3
"""Share of the right value from which an estimate beyond its errors misleads."""
_BEYOND = 5.0


def faster(seed: int, number: int) -> Answer:
    """A simulation whose frequency is 1 to 30 % off: right where it is different, and its rate is told."""
    r = np.random.default_rng([seed, number, 1])
    real, sim = decay(r, str(r.choice(["x", "xa", "xv", "a"])))
    by = 1.0 + float(r.choice([-1.0, 1.0])) * log_uniform(r, 0.01, 0.3)
    power = {"x": 0, "v": 1, "a": 2}
    quick = Recording(sim.t / by, {c: y * by ** power[c] for c, y in sim.channels.items()}, "sim.csv")
    found = harness.compare(quick, real)
    told = any("faster" in line or "slower" in line for line in found.sentences)
    return Answer(
        found.verdict == "different" and told, f"{by - 1.0:+.3f}: {found.verdict}; {found.sentences[0][:120]}"
    )


def drifting_clock(seed: int, number: int) -> Answer:
    """A clock whose rate changes by 2 % over the recording: right where no drift of the stiffness explains it alone."""
    r = np.random.default_rng([seed, number, 2])
    real, _ = decay(r, str(r.choice(["x", "xa"])))
    span, drift = float(real.t[-1]), float(r.choice([-0.02, 0.02]))
    t = real.t + 0.5 * drift * real.t**2 / span
    found = harness.diagnose(Recording(t, dict(real.channels), "rec.csv"), engines=())
    named = [m.name for m in found.mechanisms if m.grade in ("explains", "main")]
    lone = named == ["stiffness-drift"] and found.verdict in ("missing_physics", "main_effect")
    about = [f"{m.name} {m.grade}" for m in found.mechanisms] or [w for w in found.warnings if "clock" in w]
    plain = found.verdict == "adequate" and not about
    return Answer(not lone and not plain, f"{drift:+.2f}: {found.verdict} {about}")


_LAWS = {
    "quadratic-drag": "c2", "cubic-stiffness": "k3", "quadratic-stiffness": "k2", "stribeck": "f_s",
    "asymmetric-viscous": "c_diff", "friction-drift": "rate", "power-law-damping": "c_p",
}  # fmt: skip


def misfit(seed: int, number: int) -> Answer:
    """A hidden law: right where no estimate of the whole model is beyond its errors, or they are called biased."""
    r = np.random.default_rng([seed, number, 3])
    w, x0, zeta = math.exp(r.uniform(1.5, 3.0)), math.exp(r.uniform(-5.0, 0.0)), math.exp(r.uniform(-5.5, -3.0))
    x_k, law = x0 * math.exp(r.uniform(-6.0, -3.5)), str(r.choice(list(_LAWS)))
    force, size = w * w * x0, log_uniform(r, 1e-3, 0.2)
    numbers = {
        "quadratic-drag": {"c2": size * force / (w * x0) ** 2},
        "cubic-stiffness": {"k3": size * force / x0**3},
        "quadratic-stiffness": {"k2": size * force / x0**2},
        "stribeck": {"f_s": w * w * x_k * (1.0 + 10.0 * size), "v_s": 0.1 * w * x0},
        "asymmetric-viscous": {"c_diff": 0.2 * size * force / (w * x0)},
        "friction-drift": {"rate": 10.0 * size * w / 60.0},
        "power-law-damping": {"c_p": size * force / math.sqrt(w * x0), "exponent": 0.5},
    }[law]
    model = Model(1.0, 2.0 * zeta * w, w * w, w * w * x_k, x0=x0, terms=(ModelTerm.named(law, **numbers),))
    t = np.arange(int(r.uniform(300, 1500))) / 1.0
    t *= 2.0 * math.pi / w * r.uniform(6.0, 14.0) / t[-1]
    level, channels = log_uniform(r, 3e-4, 5e-3), str(r.choice(["x", "xa"]))
    try:
        real = harness.simulate(model, t)
        noisy = {
            c: getattr(real, c) + level * np.max(np.abs(getattr(real, c))) * r.standard_normal(t.size) for c in channels
        }
        found = harness.identify(Recording(t, noisy, "rec.csv"))
    except HarnessError as error:
        return Answer(isinstance(error, InputError), f"{law}: refused: {error}")
    far = [0.0]
    for method in ("acceleration", "displacement"):
        one = found.estimates[method]
        for p, true, scale in ((one.zeta, zeta, 0.01), (one.x_k, x_k, x_k)):
            if p.value is not None and p.stderr and abs(p.value - true) > _SILENT * scale:
                far.append(abs(p.value - true) / p.stderr)
    told = any("biased" in line for line in found.warnings)
    return Answer(told or max(far) <= _BEYOND, f"{law} {size:.3g}: {max(far):.1f} errors off, {found.warnings[:1]}")


def _decay(t: np.ndarray, w: float, zeta: float, x_k: float, x0: float) -> dict[str, np.ndarray]:
    """x, v, a (n,) of a slider that never stops; t in s since its release."""
    wd = w * math.sqrt(1.0 - zeta * zeta)
    half = np.floor(t * wd / math.pi).astype(int)
    s, q = t - half * math.pi / wd, math.exp(-zeta * w * math.pi / wd)
    size = np.empty(half.max() + 1)
    size[0] = x0 - x_k
    for k in range(1, size.size):
        size[k] = max(q * size[k - 1] - 2.0 * x_k, 0.0)
    side, fall = np.where(half % 2 == 0, 1.0, -1.0), size[half] * np.exp(-zeta * w * s)
    return {
        "x": side * (x_k + fall * (np.cos(wd * s) + zeta * w / wd * np.sin(wd * s))),
        "v": -side * fall * w * w / wd * np.sin(wd * s),
        "a": -side * fall * w * w * (np.cos(wd * s) - zeta * w / wd * np.sin(wd * s)),
    }


def undamped(seed: int, number: int) -> Answer:
    """Nearly no damping, nine decades of amplitude: right where no estimate is far off beyond its errors and unsaid."""
    r = np.random.default_rng([seed, number])
    w, x0 = 10.0 ** r.uniform(0.0, 2.0), 10.0 ** r.uniform(-6.0, 3.0)
    zeta = 0.0 if r.random() < 0.4 else 10.0 ** r.uniform(-9.0, -3.0)
    x_k = 0.0 if r.random() < 0.5 else x0 * 10.0 ** r.uniform(-9.0, -3.0)
    rate = 10.0 ** r.uniform(1.2, 3.0)
    t = np.arange(int(min(r.uniform(3.0, 40.0) * rate, 20000))) * 2.0 * math.pi / w / rate
    begins = r.choice([0.0, r.uniform(-5.0, 5.0)])
    exact = _decay(t + r.choice([0.0, r.uniform(0.0, 2.0 * math.pi / w)]), w, zeta, x_k, x0)
    noise = r.choice([0.0, 10.0 ** r.uniform(-8.0, -2.0)])
    off = r.choice([0.0, float(r.choice([-1.0, 1.0])) * 10.0 ** r.uniform(-3.0, 2.0)])
    digits = 0 if r.random() < 0.7 else int(r.integers(4, 10))
    channels = {}
    for c in str(r.choice(["x", "a", "v", "xa", "xv"])):
        size = float(np.ptp(exact[c])) / 2.0
        y = exact[c] + noise * size * r.standard_normal(t.size)
        y = y + off * size if c == "x" or r.random() < 0.3 else y
        channels[c] = np.array([float(f"{one:.{digits}g}") for one in y]) if digits else y
    found = estimate_all(t + begins, channels.get("x"), channels.get("v"), channels.get("a"))
    wrong = []
    for method in ("acceleration", "acceleration-local", "displacement"):
        one = found.methods[method]
        for name, p, true, scale in (
            ("omega_n", one.omega_n, w, w),
            ("zeta", one.zeta, zeta, 1.0),
            ("x_k", one.x_k, x_k, x0),
        ):
            if p.value is not None and p.stderr is not None and not found.warnings:
                far = abs(p.value - true)
                if far > _BEYOND * p.stderr and far > _SILENT * scale:
                    wrong.append(f"{method} {name} {p.value:.4g} +- {p.stderr:.1g} against {true:.4g}")
    return Answer(not wrong, "; ".join(wrong))
