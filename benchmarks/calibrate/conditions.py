"""Two conditions of one machine, a few recordings of each: is what changed told, and nothing else?

The plant shares no formula with the program: each swing is integrated between its turning points by a general solver.
Repeats differ a little in damping, friction and spring, and begin at other amplitudes; in a third of the machines a
hardening spring is hidden in both conditions.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.calibrate.calibration import Calibration, stands
from benchmarks.draws.shared import interval
from harness.app.diagnose.change import result_of
from harness.app.diagnose.options import DiagnoseOptions
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.diagnosis.change import INERTIA
from harness.diagnosis.rules import MOVED
from harness.io.options import ReadOptions

_KINDS = ("same", "brake", "magnet", "spring", "load", "medium")
_TOLD = {"brake": "f_k", "magnet": "c", "spring": "k", "load": INERTIA, "medium": "quadratic-drag.c2"}
_SAMPLES, _RATE = 2400, 200.0
_REPEATS, _OF_SPRING = 0.005, 0.001
_FALSE = 0.05


@dataclass(frozen=True, slots=True)
class _Machine:
    """m x'' = -k x - k3 x^3 - c v - drag v |v| - f sign(v)."""

    m: float
    c: float
    k: float
    f: float
    k3: float = 0.0
    drag: float = 0.0


def _swing(one: _Machine, start: float) -> FloatArray:
    """x (n,) at even times, let go at rest, until it stays."""
    t = np.arange(_SAMPLES) / _RATE
    x, now, here = np.full(t.size, np.nan), 0.0, start
    while now < t[-1] and one.k * abs(here) + one.k3 * abs(here) ** 3 > one.f:
        side = np.sign(here)

        def fall(_: float, y: FloatArray, side: float = side) -> list[float]:
            force = -one.k * y[0] - one.k3 * y[0] ** 3 - one.c * y[1] - one.drag * y[1] * abs(y[1]) + side * one.f
            return [y[1], force / one.m]

        def turns(_: float, y: FloatArray) -> float:
            return float(y[1])

        turns.terminal, turns.direction = True, side  # type: ignore[attr-defined]
        end = now + 2.0 * np.pi * np.sqrt(one.m / one.k)
        run = solve_ivp(
            fall, (now, end), [here, 0.0], "DOP853", rtol=1e-10, atol=1e-13, events=turns, dense_output=True
        )
        last = float(run.t_events[0][-1]) if run.t_events[0].size else end
        inside = (t >= now) & (t <= last)
        x[inside] = run.sol(t[inside])[0]
        now, here = last, float(run.sol(last)[0])
    x[np.isnan(x)] = here
    return x


@dataclass(frozen=True, slots=True)
class Tested:
    """kind : what was changed. told : whether that, its direction, and nothing else was said. held : unmoved numbers
    that stay within two errors, of so many.
    """

    kind: str
    told: bool
    said: str
    held: int
    of: int


def measure(seed: int, index: int) -> Tested:
    """One machine in two conditions. Raises HarnessError."""
    r, kind = np.random.default_rng([seed, 61, index]), _KINDS[index % len(_KINDS)]
    size, k = 0.1, float(r.uniform(40.0, 200.0))
    first = _Machine(1.0, float(r.uniform(0.1, 0.5)), k, k * size * float(r.uniform(0.005, 0.03)))
    if index % 3 == 0:
        first = _moved(first, k3=k / size**2 * float(r.uniform(0.03, 0.15)))
    more = {
        "same": lambda: first,
        "brake": lambda: _moved(first, f=first.f * float(r.uniform(1.15, 2.0))),
        "magnet": lambda: _moved(first, c=first.c * float(r.uniform(1.2, 3.0))),
        "spring": lambda: _moved(first, k=first.k * float(r.uniform(1.03, 1.15))),
        "load": lambda: _moved(first, m=float(r.uniform(1.06, 1.4))),
        "medium": lambda: _moved(first, drag=float(r.uniform(0.05, 0.3)) / size),
    }[kind]()
    count, noise = int(r.integers(1, 4)), size * float(np.exp(r.uniform(np.log(1e-4), np.log(3e-3))))
    groups = [[_recorded(one, size, noise, r, f"{name}-{i}.csv") for i in range(count)]
              for name, one in (("before", first), ("after", more))]  # fmt: skip
    result = result_of(groups[0], groups[1], DiagnoseOptions.chosen(ReadOptions(), zero="spring", engines=()))
    wanted = [] if kind == "same" else [_TOLD[kind]]
    grown = all(one.ratio.value is None or one.ratio.value > 1.0 for one in result.numbers if one.name in wanted)
    moved = {*wanted, *({"c", "k", "f_k"} if kind == "load" else ()), INERTIA}
    near = [
        abs(one.ratio.value - 1.0) <= 2.0 * one.ratio.stderr
        for one in result.numbers
        if one.name in ("c", "k", "f_k") and one.name not in moved
        and one.ratio.value is not None and one.ratio.stderr is not None
    ]  # fmt: skip
    return Tested(kind, result.changed == wanted and grown, result.statement, sum(near), len(near))


def _moved(one: _Machine, **more: float) -> _Machine:
    values = {name: getattr(one, name) for name in ("m", "c", "k", "f", "k3", "drag")}
    return _Machine(**{**values, **more})


def _recorded(one: _Machine, size: float, noise: float, r: np.random.Generator, file: str) -> Recording:
    """A repeat of a condition, from an amplitude of its own."""
    spread = {"c": _REPEATS, "f": _REPEATS, "k": _OF_SPRING}
    repeat = _moved(one, **{name: getattr(one, name) * (1.0 + s * r.standard_normal()) for name, s in spread.items()})
    x = _swing(repeat, size * float(r.uniform(0.7, 1.0)))
    t = np.arange(x.size) / _RATE
    return Recording(t, {"x": x + noise * r.standard_normal(x.size)}, file)


def said(rows: Sequence[Tested]) -> Iterator[str]:
    """By what was changed, and how often unmoved numbers stay."""
    for kind in _KINDS:
        own = [row for row in rows if row.kind == kind]
        yield f"{kind}: {sum(row.told for row in own)} of {len(own)}"
    changed = [row for row in rows if row.kind != "same"]
    right = sum(row.told for row in changed)
    yield f"what changed is told, and nothing else: {_rate(right, len(changed))}"
    yield f"unmoved within two errors: {_rate(sum(row.held for row in rows), sum(row.of for row in rows))}"
    same = [row for row in rows if row.kind == "same"]
    false = sum(not row.told for row in same)
    yield stands(MOVED, false <= _FALSE * len(same) + 1, f"{false} of {len(same)} alike are called different")
    for row in rows:
        if not row.told:
            yield f"missed, {row.kind}: {row.said}"


def _rate(right: int, of: int) -> str:
    low, high = interval(right, of)
    return f"{right} of {of} ({100.0 * low:.1f} to {100.0 * high:.1f} %)"


CALIBRATION = Calibration(measure, said, "what changed between two conditions of a machine")
