"""Creep of chains of joints against the iterations of MuJoCo's solver: ``python -m benchmarks.iterations [--seeds N]``.

Chains of revolute joints with dry friction and damping slide to a stop with half of the friction on each, 2 ms,
ls_iterations 50, friction as stiff as the step allows. Prints the table of docs/fidelity.md.
"""

import argparse
import time
from collections.abc import Sequence

import mujoco
import numpy as np

from harness.fidelity.laws import newton_iterations

STEP = 2e-3
"""s."""
_JOINTS = 2, 3, 6, 12
_FULL, _SLID, _LONG = 100, 1e-3, 10_000
"""Iterations that are enough, rad/s above which a chain still slides, and steps after which most do not."""
_LINK = """<body pos="{at} 0 0"><joint axis="{axis}" frictionloss="{f}" damping="{c}" armature=".02"
solreffriction="{time} 1" solimpfriction=".9999 .9999 .001"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".02"
mass="{m}" contype="0" conaffinity="0"/>"""
_AXES = "1 0 0", "0 1 0", "0 0 1"

Link = tuple[float, float, float]
"""Friction, N m, damping, N m s/rad, mass, kg."""


def chain_creep(
    links: Sequence[Link], integrator: str, iterations: int, search: int = 50, steps: int = 2000
) -> tuple[float, float]:
    """rad/s of the fastest joint after a chain slid to a stop in ``steps``, and steps a second."""
    bodies = "".join(
        _LINK.format(at=0.3 * (i > 0), axis=_AXES[i % 3], f=f, c=c, m=m, time=2.0 * STEP)
        for i, (f, c, m) in enumerate(links)
    )
    option = f'timestep="{STEP}" iterations="{iterations}" ls_iterations="{search}" integrator="{integrator}"'
    text = f"<mujoco><option {option} gravity='0 0 0'/><worldbody>{bodies}{'</body>' * len(links)}</worldbody></mujoco>"
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qvel[:] = 0.5
    data.qfrc_applied[:] = 0.5 * model.dof_frictionloss * np.where(np.arange(len(links)) % 2, 1.0, -1.0)
    began = time.perf_counter()
    mujoco.mj_step(model, data, steps)
    before = data.qpos.copy()
    mujoco.mj_step(model, data, steps // 4)
    taken = time.perf_counter() - began
    creep = float(np.max(np.abs(data.qpos - before))) / (steps // 4 * STEP)
    return creep, (steps + steps // 4) / taken


def _chain(joints: int, seed: int) -> list[Link]:
    random = np.random.default_rng([joints, seed])
    low, high = np.log([(0.3, 0.01, 0.1), (5.0, 2.0, 1.0)])
    drawn = np.exp(random.uniform(low, high, (joints, low.size)))
    return [(float(f), float(c), float(m)) for f, c, m in drawn]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=25, metavar="N")
    seeds = range(parser.parse_args().seeds)
    print("| joints | 1 iteration | 4 | joints + 1 | 100 | slid to a stop | 1000 steps/s: 4/8, joints + 1 |")
    print("|---|---|---|---|---|---|---|")
    alike = every = 0
    for joints in _JOINTS:
        chains = [(_chain(joints, seed), ("Euler", "implicitfast")[seed % 2]) for seed in seeds]
        full = [chain_creep(links, how, _FULL, steps=_LONG)[0] for links, how in chains]
        stopped = [(one, creep) for one, creep in zip(chains, full, strict=True) if creep < _SLID]
        worst, speed = [], []
        for iterations in (1, 4, newton_iterations(joints)):
            found = [chain_creep(links, how, iterations, steps=_LONG) for (links, how), _ in stopped]
            worst.append(max(creep for creep, _ in found))
            speed.append(float(np.median([rate for _, rate in found])))
        alike += sum(creep < 1.01 * own for (creep, _), (_, own) in zip(found, stopped, strict=True))
        every += len(stopped)
        often = float(np.median([chain_creep(links, how, 4, 8, _LONG)[1] for (links, how), _ in stopped]))
        shown = " | ".join(f"{creep:.1g}" for creep in (*worst, max(creep for _, creep in stopped)))
        of = f"{len(stopped)} of {len(chains)}"
        print(f"| {joints} | {shown} | {of} | {often / 1e3:.0f}, {speed[-1] / 1e3:.0f} |", flush=True)
    print(f"\nOf {every} chains that slid to a stop {alike} crept with joints + 1 iterations as with {_FULL}.")


if __name__ == "__main__":
    main()
