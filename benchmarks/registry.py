"""The rows there are, and how one is timed: ours and the peer alternated, medians of both."""

import importlib
import pkgutil
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

Action = Callable[[], object]

_SHORTEST_S = 5e-3  # a round shorter than this is repeated inside the clock


@dataclass(frozen=True, slots=True)
class Pair:
    """What a row times: two actions without arguments, everything prepared beforehand (compiled, allocated)."""

    ours: Action
    peer: Action
    rounds: int = 9


@dataclass(frozen=True, slots=True)
class Benchmark:
    """A row before it is timed. target : the largest ratio that is good, None where the figure is for information."""

    name: str
    peer: str
    timed: str
    target: float | None
    prepare: Callable[[], Pair]


@dataclass(frozen=True, slots=True)
class Row:
    """A row of the result; ratio = ours_s / peer_s."""

    name: str
    timed: str
    ours_s: float
    peer: str
    peer_s: float
    ratio: float
    target: float | None
    met: bool


_BENCHMARKS: dict[str, Benchmark] = {}


def benchmark(
    name: str, *, peer: str, timed: str, target: float | None
) -> Callable[[Callable[[], Pair]], Callable[[], Pair]]:
    """Register the function below it, which prepares a Pair, as a row. Raises ValueError when the name is taken."""

    def register(prepare: Callable[[], Pair]) -> Callable[[], Pair]:
        if name in _BENCHMARKS:
            raise ValueError(f"two benchmarks are called {name}")
        _BENCHMARKS[name] = Benchmark(name, peer, timed, target, prepare)
        return prepare

    return register


def all_benchmarks() -> list[Benchmark]:
    """Every row of every module of this package, in the order of module and definition."""
    for module in sorted(pkgutil.iter_modules([str(Path(__file__).parent)]), key=lambda m: m.name):
        if not module.name.startswith("_"):
            importlib.import_module(f"benchmarks.{module.name}")
    return list(_BENCHMARKS.values())


def _time(action: Action, loops: int) -> float:
    start = time.perf_counter()
    for _ in range(loops):
        action()
    return (time.perf_counter() - start) / loops


def _loops(action: Action) -> int:
    """How often to repeat inside the clock; also warms up."""
    action()
    return max(1, round(_SHORTEST_S / max(_time(action, 1), 1e-9)))


def run(item: Benchmark) -> Row:
    """Time one row."""
    pair = item.prepare()
    ours_loops, peer_loops = _loops(pair.ours), _loops(pair.peer)
    ours, peer = [], []
    for _ in range(pair.rounds):
        ours.append(_time(pair.ours, ours_loops))
        peer.append(_time(pair.peer, peer_loops))
    ours_s, peer_s = statistics.median(ours), statistics.median(peer)
    ratio = ours_s / peer_s
    met = item.target is None or ratio <= item.target
    return Row(item.name, item.timed, ours_s, item.peer, peer_s, ratio, item.target, met)
