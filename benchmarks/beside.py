"""``python -m benchmarks.beside --draws N --seed S``: ours beside what a practitioner would do, on the same recordings.

A random part of the cases of the proof on all ways, of those with a balance of forces: each is asked by us, by the law
whose addition to a regression raises R^2 most, by Lasso (scikit-learn, BIC chooses) and by STLSQ (pysindy, BIC
chooses) over the catalogue's columns, by a Gaussian process of what plain friction leaves (scikit-learn: is anything
missing), of a free decay by mujoco.sysid, of a robot's joint by plain regression. Margins are ours less theirs with a
bootstrap interval over cases, paired.
"""

import argparse
import json
import math
import sys
import tempfile
import warnings
from collections.abc import Callable, Mapping, Sequence
from contextlib import chdir, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.signal import savgol_filter

import harness
from harness.app.prove.blind_worker import answered
from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.io.recording import read_recording
from harness.proof.baselines.regression import LEAST_GAIN, RIDGE, THRESHOLDS
from harness.proof.baselines.sysid import holdout_by_sysid
from harness.proof.machines.score import holdout_ratio
from harness.proof.paths.files import unpacked
from harness.proof.paths.forms import AXIS, CURVE, DECAY, DOWN, JOINT, SHAKEN, SLOW, SPRING, SWING, laws
from harness.proof.paths.made import CONTROL, FORM, UNKNOWN, Made, forms_of, made, shapes_of
from harness.proof.paths.score import PLAIN, is_hidden, right, within
from harness.proof.statistics import resampled
from harness.proof.tally import OURS

WAYS = (DECAY, SWING, DOWN, SPRING, SHAKEN, AXIS, SLOW, CURVE, JOINT)
SHARE = 0.1
"""Of a period: the window in which positions are smoothed."""
_FIRST = 9
_MOST = 1500
"""Samples that laws are chosen on."""
_PARTS = 150
"""Samples that the Gaussian process gets."""


@dataclass(frozen=True, slots=True)
class Balance:
    """What a regression sees. y (n,) : force, or acceleration of what nothing drives. base, names : columns of plain
    friction and of laws (n,). x, v, t (n,). worth : independent samples.
    """

    y: FloatArray
    base: Mapping[str, FloatArray]
    laws: Mapping[str, FloatArray]
    x: FloatArray
    v: FloatArray
    t: FloatArray
    worth: float

    @property
    def left(self) -> FloatArray:
        """What plain friction leaves, (n,)."""
        return _without(self.y, list(self.base.values()))


def _without(y: FloatArray, columns: Sequence[FloatArray]) -> FloatArray:
    table = np.column_stack([c / max(float(np.max(np.abs(c))), 1e-300) for c in columns])
    return np.asarray(y - table @ np.linalg.lstsq(table, y, rcond=1e-9)[0])


def balance(path: str) -> Balance:
    """Of the recording in this folder, differentiated through a window of a tenth of its period."""
    if path == JOINT:
        log = harness.load_log("recording.csv", joints=["elbow", "wrist"])
        t, seen = log.t, {"x": log.position["elbow"], "u": log.effort["elbow"]}
    else:
        recording = read_recording(Path("recording.csv"))
        t, seen = recording.t, dict(recording.channels)
    if path == CURVE:
        v, u = seen["v"], seen["u"]
        found = laws(np.zeros_like(v), v, np.arange(float(v.size)))
        shown = ("quadratic-drag", "power-law-damping", "asymmetric-viscous", "stribeck")
        base = {"c": v, "f_k": np.sign(v)}
        return _chosen(u, base, {name: found[name] for name in shown}, np.zeros_like(v), v, t, float(v.size))
    dt = float(t[1] - t[0])

    def motion(width: int) -> list[FloatArray]:
        if "x" in seen:
            return [np.asarray(savgol_filter(seen["x"], width, 3, deriv=n, delta=dt)) for n in range(3)]
        if "v" in seen:
            v, a = (np.asarray(savgol_filter(seen["v"], width, 3, deriv=n, delta=dt)) for n in range(2))
            return [np.cumsum(v) * dt, v, a]
        # of an acceleration alone what it sums up to, without what sums of noise make of it
        a = np.asarray(savgol_filter(seen["a"], width, 3))
        v = _without(np.cumsum(a) * dt, [np.ones_like(t), t])
        return [_without(np.cumsum(v) * dt, [np.ones_like(t), t, t**2]), v, a]

    x, v, _ = motion(_FIRST)
    period = 2.0 * math.pi * float(np.std(x)) / max(float(np.std(v)), 1e-300)
    width = min(max(5, 2 * int(0.5 * SHARE * period / dt) + 1), 2 * (t.size // 20) + 1)
    x, v, a = motion(width)
    y = a if "u" not in seen else np.asarray(savgol_filter(seen["u"], width, 3))
    base = {"c": v, "f_k": np.sign(v)} | ({} if path == DOWN else {"1": np.ones_like(v)})
    if "u" in seen:
        base["m"] = a
    if path in (DECAY, SPRING):
        base["k"] = x
    if path in (SWING, SHAKEN, JOINT):
        base |= {"sin": np.sin(x), "cos": np.cos(x)}
    moving = np.abs(v) > 0.02 * np.max(np.abs(v))
    moving[: width // 2] = moving[t.size - width // 2 :] = False
    worth = max(float(np.sum(moving)) / width, 10.0)
    moving[np.arange(t.size) % max(1, t.size // _MOST) > 0] = False
    smooth = {name: _smoothed(column, width) if name == "f_k" else column for name, column in base.items()}
    found = {name: [_smoothed(one, width)[..., moving] for one in tries] for name, tries in laws(x, v, t).items()}
    kept = {name: column[moving] for name, column in smooth.items()}
    return _chosen(y[moving], kept, found, x[moving], v[moving], t[moving], worth)


def _smoothed(column: FloatArray, width: int) -> FloatArray:
    """As smoothing shows it."""
    return np.asarray(savgol_filter(column, width, 3, axis=-1))


def _chosen(
    y: FloatArray, base: Mapping[str, FloatArray], found: Mapping[str, list[FloatArray]], x: FloatArray, v: FloatArray,
    t: FloatArray, worth: float,
) -> Balance:  # fmt: skip
    """Of every law the form, and of two columns the phase, that explains most of what plain friction leaves."""
    columns = list(base.values())
    left = _without(y, columns)

    def summed(law: FloatArray) -> FloatArray:
        own = np.column_stack([_without(one, columns) for one in np.atleast_2d(law)])
        return np.asarray(np.linalg.lstsq(own, left, rcond=1e-9)[0] @ np.atleast_2d(law)) if law.ndim > 1 else law

    best = {
        name: min(map(summed, tries), key=lambda one: float(np.sum(_without(y, [*columns, one]) ** 2)))
        for name, tries in found.items()
    }
    return Balance(y, base, best, x, v, t, worth)


def by_r2(b: Balance) -> list[str]:
    """The law that raises R^2 most, or none."""
    before, columns = float(np.sum(b.left**2)), list(b.base.values())
    after = {name: float(np.sum(_without(b.y, [*columns, one]) ** 2)) for name, one in b.laws.items()}
    best = min(after, key=lambda name: after[name])
    return [best] if before - after[best] > LEAST_GAIN * before else []


def _beside(b: Balance) -> tuple[FloatArray, FloatArray, list[str]]:
    """What plain friction leaves of the force and of the laws' columns, each of unit size, and the laws' names."""
    columns, left = list(b.base.values()), b.left
    rest = {name: _without(one, columns) for name, one in b.laws.items()}
    names = [name for name, one in rest.items() if np.std(one) > 1e-6 * np.std(b.laws[name])]
    table = np.column_stack([rest[name] / np.std(rest[name]) for name in names])
    return left / max(float(np.std(left)), 1e-300), table, names


def by_lasso(b: Balance) -> list[str]:
    from sklearn.linear_model import LassoLarsIC

    y, table, names = _beside(b)
    if y.size <= 2 * len(names):
        return []
    # one independent sample in each smoothing window, and enough for a variance
    thin = slice(None, None, max(1, int(y.size / max(b.worth, 3.0 * len(names)))))
    found = LassoLarsIC(criterion="bic").fit(table[thin], y[thin])
    return [name for name, size in zip(names, found.coef_, strict=True) if size != 0.0]


def by_stlsq(b: Balance) -> list[str]:
    import pysindy

    y, table, names = _beside(b)
    best: tuple[float, list[str]] = b.worth * math.log(float(np.mean(y**2))), []
    for threshold in THRESHOLDS:
        with warnings.catch_warnings():
            # of coefficients all below the threshold, which is an answer
            warnings.simplefilter("ignore")
            found = pysindy.STLSQ(threshold=threshold, alpha=RIDGE).fit(table, y[:, None]).coef_[0]
        count = int(np.count_nonzero(found))
        bic = b.worth * math.log(float(np.mean((y - table @ found) ** 2))) + count * math.log(b.worth)
        if bic < best[0]:
            best = bic, [name for name, size in zip(names, found, strict=True) if size != 0.0]
    return best[1]


def by_process(b: Balance) -> bool:
    """Whether what is left is a function of place, speed and time rather than noise, by the marginal likelihood."""
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

    at = np.linspace(0, b.y.size - 1, min(_PARTS, int(b.worth), b.y.size)).astype(int)
    y = b.left[at] / max(float(np.std(b.left[at])), 1e-300)
    seen = np.column_stack([(one[at] - np.mean(one)) / (np.std(one) or 1.0) for one in (b.x, b.v, b.t)])
    smooth = ConstantKernel(0.5) * RBF([1.0, 1.0, 1.0], (0.05, 100.0)) + WhiteKernel(0.5)
    with warnings.catch_warnings():
        # of lengths that end on their bounds
        warnings.simplefilter("ignore")
        each = [GaussianProcessRegressor(kernel, random_state=0).fit(seen, y) for kernel in (smooth, WhiteKernel(1.0))]
    gain = each[0].log_marginal_likelihood_value_ - each[1].log_marginal_likelihood_value_
    return bool(gain > 0.5 * 4.0 * math.log(y.size))


def by_regression(b: Balance) -> dict[str, tuple[float, float]]:
    """Friction of a joint and its standard errors, by least squares."""
    names, table = list(b.base), np.column_stack(list(b.base.values()))
    inverse = np.linalg.pinv(table.T @ table)
    numbers = inverse @ table.T @ b.y
    left = b.y - table @ numbers
    errors = np.sqrt(np.diag(inverse) * float(left @ left) / max(b.y.size - len(names), 1))
    return {name: (float(n), float(e)) for name, n, e in zip(names, numbers, errors, strict=True)}


NAMERS: dict[str, Callable[[Balance], list[str]]] = {
    "best R^2": by_r2, "Lasso, scikit-learn": by_lasso, "STLSQ, pysindy": by_stlsq,
}  # fmt: skip
PROCESS, SYSID, REGRESSION = "Gaussian process, scikit-learn", "mujoco.sysid", "plain regression"
Pair = tuple[float, float]
"""Ours and theirs."""


def drawn(seed: int, number: int) -> tuple[str, Made]:
    """A case: any way, half of them with nothing hidden, of the others every fourth an effect of no name."""
    rng = np.random.default_rng([seed, number])
    path = WAYS[int(rng.integers(len(WAYS)))]
    group = CONTROL if rng.random() < 0.5 else UNKNOWN if rng.random() < 0.25 else FORM
    names = {CONTROL: [""], UNKNOWN: shapes_of(path), FORM: forms_of(path)}[group]
    return path, made(seed, number, path, group, names[int(rng.integers(len(names)))])


def pairs(path: str, one: Made) -> dict[tuple[str, str], Pair]:
    """Ours and theirs of one case, by baseline and what is compared."""
    truth, found = one.answer, dict[tuple[str, str], Pair]()
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        ours: dict[str, Any] = json.loads(answered(OURS, truth["arguments"], one.recording))
        for name, text in (unpacked(one.recording) or {}).items():
            Path(name).write_text(text, encoding="utf-8")
        b = balance(path)
        hidden = is_hidden(truth)
        what = f"effect worth above {PLAIN:g} named" if hidden else "nothing named where nothing is"
        for who, names in NAMERS.items() if truth["loss"] > PLAIN or not hidden else ():
            said = {"verdict": "main_effect", "mechanisms": [{"name": name, "grade": "main"} for name in names(b)]}
            found[who, what] = float(right(truth, ours)), float(right(truth, said))
        missing = truth["group"] != CONTROL
        what = "told that something is missing" if missing else "told that nothing is"
        found[PROCESS, what] = float((ours["verdict"] != "adequate") == missing), float(by_process(b) == missing)
        if path == JOINT and not missing:
            numbers = {n: {"value": value, "stderr": error} for n, (value, error) in by_regression(b).items()}
            for name in ("c", "f_k"):
                own = {**truth, "base": {name: truth["base"][name]}}
                each = [within(own, one) for one in (ours, {"refined": {"parameters": numbers}})]
                if all(each):
                    found[REGRESSION, f"{name} within two errors"] = float(each[0][0]), float(each[1][0])
        spans = (ours.get("holdout") or {}).get("spans_s")
        if path == DECAY and hidden and spans and truth["channels"] == "x":
            recording = read_recording(Path("recording.csv"))
            theirs = holdout_by_sysid({"t": recording.t, **recording.channels}, spans).rmse.get("x")
            mine = ours["holdout"]["refined_rmse"].get("x")
            if theirs and mine and math.isfinite(holdout_ratio(ours["holdout"])):
                found[SYSID, "minus log of held-out error"] = -math.log(mine), -math.log(theirs)
    return found


def table(said: Sequence[Mapping[tuple[str, str], Pair]]) -> str:
    """Baseline, what is compared, cases, ours, theirs, ours less theirs with its interval."""
    lines = [f"{'baseline':30s} {'what':38s} cases  ours  theirs  margin (95 % interval)"]
    for key in dict.fromkeys(key for one in said for key in one):
        ours, theirs = np.array([one[key] for one in said if key in one]).T
        low, high = resampled(ours - theirs, lambda picks: np.mean(picks, axis=1))
        shown = (
            f"{np.mean(ours):6.2f} {np.mean(theirs):6.2f}  {np.mean(ours - theirs):+.2f} ({low:+.2f} to {high:+.2f})"
        )
        lines.append(f"{key[0]:30s} {key[1]:38s} {ours.size:5d} {shown}")
    return "\n".join(lines)


def main(argv: Sequence[str] | None = None) -> int:
    """Draw, ask and print, of what was asked where it is interrupted; exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.beside", description=__doc__)
    parser.add_argument("--draws", type=int, default=40)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    told = parser.parse_args(argv)
    said = []
    with suppress(KeyboardInterrupt):
        for number in range(told.first, told.first + told.draws):
            try:
                path, one = drawn(told.seed, number)
            except SimulationError as error:
                print(f"{number:4d} {error}", flush=True)
                continue
            said.append(pairs(path, one))
            print(f"{number:4d} {path}: {one.answer['form'] or 'nothing'}, worth {one.answer['loss']:.3g}", flush=True)
    print(table(said))
    return 0


if __name__ == "__main__":
    sys.exit(main())
