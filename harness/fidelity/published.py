"""What others publish of engines' friction, and what rows of this suite say to it."""

from dataclasses import dataclass

_LAB = "https://isaac-sim.github.io/IsaacLab"


@dataclass(frozen=True, slots=True)
class Published:
    """A statement, in our words, and the row that confirms or contradicts it.

    row : as the published baseline names it, metric : of it, value : in SI units, None where the row has it beside its
    metrics. verdict : in a word. why : what the row shows.
    """

    source: str
    address: str
    says: str
    verdict: str
    why: str
    row: str
    metric: str
    value: float | None


PUBLISHED = (
    Published(
        "Isaac Lab 3.0, Solver Differences",
        f"{_LAB}/release/3.0.0/source/concepts/solver_differences.html",
        "equal coefficients of friction need not slip alike in two engines",
        "confirmed",
        "a box that asks for half of its friction creeps at 0.43 mm/s in MuJoCo as shipped, and not at all in PyBullet",
        "mujoco@4.0.0/contact/as-shipped/dt=own/hold-50",
        "creep_m_s",
        4.328e-4,
    ),
    Published(
        "Isaac Lab 3.0, Solver Differences",
        f"{_LAB}/release/3.0.0/source/concepts/solver_differences.html",
        "MJWarp has MuJoCo's model of contact, its cones and impratio among it",
        "confirmed",
        "the same box creeps at 0.43 mm/s in MuJoCo Warp too, equal to four digits",
        "warp@4.0.0(mjx)/contact/as-shipped/dt=own/hold-50",
        "creep_m_s",
        4.328e-4,
    ),
    Published(
        "Isaac Lab 3.0 beta, Solver Transitioning",
        f"{_LAB}/v3.0.0-beta/source/experimental-features/newton-physics-integration/solver-transitioning.html",
        "MJWarp may be set to a pyramidal cone, impratio 1 and 10 iterations of the line search",
        "contradicted, for what is to be held",
        "that cone creeps at 0.43 mm/s with any effort; elliptic with impratio 100 at 0.004 mm/s",
        "warp@4.0.0(mjx)/contact/trained/cone=elliptic,impratio=100,iterations=4,ls_iterations=8/dt=0.002/hold-50",
        "creep_m_s",
        3.907e-6,
    ),
    Published(
        "Newton, table of supported features",
        "https://newton-physics.github.io/newton/stable/solvers/index.html#supported-features",
        "Featherstone, SemiImplicit and XPBD have articulations",
        "confirmed, without dry friction",
        "friction of a joint does nothing in them, without a word; in SolverMuJoCo it creeps at 5.1 mm/s under 97 %",
        "newton@1.8.0(newton)/joint/as-shipped/dt=own/hold-97",
        "creep_m_s",
        5.1e-3,
    ),
    Published(
        "GPUSimBench (arXiv 2607.13059)",
        "https://arxiv.org/abs/2607.13059",
        "engines on a GPU differ from run to run and from world to world though they start alike",
        "not on a CPU; a GPU was not tried",
        "every engine asked gives the same bits again, MuJoCo Warp in each of 16 worlds as well (column repeats)",
        "warp@4.0.0(mjx)/joint/as-shipped/dt=own/free-decay",
        "apart_m",
        None,
    ),
)
