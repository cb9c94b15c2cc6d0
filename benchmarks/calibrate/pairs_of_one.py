"""Two recordings of one machine of harness.proof.machines: let go from two amplitudes, with a noise and a zero each."""

from dataclasses import dataclass, replace

import numpy as np

from harness.core.recording import Recording
from harness.diagnosis.request import Asked
from harness.model.model import Restoring
from harness.proof.machines.cases import Messy, draw
from harness.proof.machines.kinds import FREE
from harness.proof.machines.shares import read

SMALLER = (0.3, 0.8)
"""The second amplitude over the first."""


@dataclass(frozen=True, slots=True)
class Two:
    """Both recordings, the larger first, and what their user would say. main : the effect, "" in a control."""

    recordings: tuple[Recording, Recording]
    asked: Asked
    main: str


def two(rng: np.random.Generator, main: str | None = None, heavier: float = 1.0, mains: tuple[str, ...] = ()) -> Two:
    """A random machine twice. heavier : its inertia the second time over the first.

    main : its effect, None for one of ``mains``, or a control or any by even chance. Raises SimulationError.
    """
    kinds = [kind for kind in FREE.values() if main in (None, "") or main in kind.names]
    kind = kinds[int(rng.integers(len(kinds)))]
    if main is None:
        names = tuple(name for name in kind.names if not mains or name in mains)
        main = str(rng.choice(list(names))) if names and (mains or rng.random() < 0.5) else ""
    case = draw(kind, main, rng)
    rig = case.rig
    b = rig.base
    share = float(rng.uniform(*SMALLER))
    # a heavier slider on the same spring, with the same damper and the same friction
    base = replace(
        b, x0=b.x0 * share, m=b.m * heavier, omega_n=b.omega_n / np.sqrt(heavier), zeta=b.zeta / np.sqrt(heavier)
    )
    later = replace(rig, base=base, zero=rig.zero + 0.3 * b.length * float(rng.normal()))
    return Two((_recorded(case, rng), _again(case, later, rng)), _asked(case), main)


def _asked(case: Messy) -> Asked:
    return Asked(Restoring(case.rig.base.restoring), zero_free=True)


def _recorded(case: Messy, rng: np.random.Generator) -> Recording:
    return _recording(case, dict(case.recorded), "first")


def _again(case: Messy, rig: object, rng: np.random.Generator) -> Recording:
    whole = read(rig, case.effects)  # type: ignore[arg-type]
    zero = rig.zero  # type: ignore[attr-defined]
    clean = {**whole.clean, "x": whole.clean["x"] + zero} if "x" in whole.clean else dict(whole.clean)
    recorded = {"t": rig.stamps, **case.noise.spoil(clean, rng)}  # type: ignore[attr-defined]
    return _recording(case, recorded, "second")


def _recording(case: Messy, recorded: dict[str, object], name: str) -> Recording:
    channels = {c: np.asarray(recorded[c]) for c in case.rig.channels}
    return Recording(np.asarray(recorded["t"]), channels, name, angular=case.rig.kind.angular)
