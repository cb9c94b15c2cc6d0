"""What a time-stepping scheme does to damping and to rest, derived in docs/fidelity.md and tested at random sliders.

m in kg, c in N s/m, k in N/m, h the step in s, n its equal sub-steps, load and limit in N.

What is known of engines without a sweep: words that do nothing, and what a robot's servo makes of its damping.
"""

import math
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray

TGS_LEFT = 1.0 / 41.0
"""What one iteration of PhysX's TGS leaves of a joint's speed that friction should stop: 1 - 1/1.025, measured."""
SAP_SIGMA = 1e-3
"""Regularisation of friction in Drake's SAP and, as its least, in its lagged and similar approximations."""


def held(m: float, c: float, k: float, h: float, n: int) -> float:
    """Damping that acts, N s/m, where spring and damper are a force held over a step of n sub-steps.

    The step's determinant is 1 - (h/m)(c - k h (1 - 1/n)/2), and damping is -(m/h) ln of it.
    """
    return -m / h * math.log1p(-h / m * (c - 0.5 * k * h * (1.0 - 1.0 / n)))


def implicit(m: float, c: float, k: float, h: float, n: int) -> float:
    """Damping that acts, N s/m, where the engine takes both at the end of each of n sub-steps.

    A sub-step's determinant is 1/(1 + (h/n)(c + k h/n)/m).
    """
    return n * m / h * math.log1p(h / n * (c + k * h / n) / m)


def tgs_creep(m: float, load: float, h: float, n: int, velocity_iterations: int) -> float:
    """Speed in m/s at which a joint of PhysX creeps under TGS with n position iterations: load h/(40 m n), nearly."""
    left, gain = TGS_LEFT, TGS_LEFT / (1.0 - TGS_LEFT)
    steady = gain * load * h / (m * n)
    # iterations of speed stop the slider once more, and the next step begins from there
    again = left**velocity_iterations
    behind = (1.0 - again) / (1.0 - again * left**n)
    return steady * (1.0 - behind * left * (1.0 - left**n) / (n * (1.0 - left)))


def line_search_creep(m: float, limit: float, h: float, ls_iterations: int) -> float:
    """Largest speed in m/s at which MuJoCo creeps after a slide where its line search is cut off: Newton, Euler, stiff
    friction, a joint without damping. Two steps of the search halve it; measured, and tested at random sliders.

    With damping at the end of the step (Euler's of a joint, implicitfast) a cut search is of no use at all: creep stays
    a share of what friction brakes in a step until the search converges, which takes up to ``CONVERGED`` of its steps.
    """
    return min(2.0, 7.0 * math.exp2(-0.5 * ls_iterations)) * limit * h / m


CONVERGED = 40
"""ls_iterations from which on MuJoCo's line search had converged in every case tried."""


def newton_iterations(joints: int) -> int:
    """Iterations of MuJoCo's solver that ``joints`` with dry friction and damping want, which move one another.

    One more than there are: each finds of about one joint whether it slides. With fewer, what is left over creeps up to
    thousands of times as fast as under full effort. All of 91 random chains of 2 to 12 joints that came to a stop
    (Newton, 2 ms, as stiff as that allows) crept as under 100 iterations (``python -m benchmarks.iterations``).
    """
    return joints + 1


def smooth_creep(tolerance: float, load: float, limit: float) -> float:
    """Speed in m/s at which v/sqrt(v^2 + v_s^2) of ``limit`` carries ``load`` (Drake, lagged and similar)."""
    share = load / limit
    return tolerance * share / math.sqrt(1.0 - share**2)


def tamsi_creep(tolerance: float, load: float, limit: float) -> float:
    """Speed in m/s at which s (2 - s) of ``limit``, s = v/v_s, carries ``load`` (Drake's TAMSI)."""
    return tolerance * (1.0 - math.sqrt(1.0 - load / limit))


def sap_creep(m: float, load: float, h: float) -> float:
    """Speed in m/s at which one contact point creeps under Drake's SAP: sigma load h |W|/3.

    |W| is the Frobenius norm of the point's inverse mass, sqrt(2)/m for a box that slides and lifts.
    """
    return SAP_SIGMA * load * h * math.sqrt(2.0) / (3.0 * m)


def least_tolerance(m: float, limit: float, h: float) -> float:
    """The stiction tolerance in m/s below which a smaller one changes nothing (Drake, lagged and similar)."""
    return sap_creep(m, limit, h)


def half_implicit(m: float, c: float, c_end: float, h: float) -> float:
    """Damping that acts, N s/m, where c is taken at the start of a step, as any spring, and c_end at its end.

    The step's determinant is (1 - h c/m)/(1 + h c_end/m): a spring held over one step is none of it.
    """
    return -m / h * (math.log1p(-h / m * c) - math.log1p(h / m * c_end))


RK4_IMAGINARY = 2.0 * math.sqrt(2.0)
"""h omega up to which the classical Runge-Kutta method is stable without damping."""


def semi_implicit_step(m: float, c: float, c_end: float, k: float, h: float) -> FloatArray:
    """What a step makes of (position, speed) of a mass on a spring, (2, 2), as do the next three.

    Speed first, c and k at the start of a step and c_end at its end, then position: MuJoCo's Euler and implicit. It
    is stable while h^2 k < 4 m - 2 h c + 2 h c_end and h c < 2 m + h c_end (Jury's conditions of this matrix).
    """
    mass = m + h * c_end
    by_x, by_v = -h * k / mass, 1.0 - h * (c + c_end) / mass
    return np.array([[1.0 + h * by_x, h * by_v], [by_x, by_v]])


def implicit_step(m: float, c: float, k: float, h: float, n: int) -> FloatArray:
    """Both at the end of each of n sub-steps; stable whatever the step."""
    part = h / n
    mass = m + part * (c + part * k)
    by_x, by_v = -part * k / mass, m / mass
    return np.linalg.matrix_power(np.array([[1.0 + part * by_x, part * by_v], [by_x, by_v]]), n)


def held_step(m: float, c: float, k: float, h: float, n: int) -> FloatArray:
    """Spring and damper as a force held over a step of n sub-steps, speed first in each."""
    way = 0.5 * h * h * (1.0 + 1.0 / n) / m
    return np.array([[1.0 - way * k, h - way * c], [-h * k / m, 1.0 - h * c / m]])


def runge_kutta_step(m: float, c: float, k: float, h: float) -> FloatArray:
    """The classical method of fourth order: Taylor's series to h^4."""
    once, found = np.array([[0.0, h], [-h * k / m, -h * c / m]]), np.eye(2)
    for i in range(4, 0, -1):
        found = np.eye(2) + once @ found / i
    return found


def stable(step: FloatArray) -> bool:
    """Whether what a step makes of a motion stays bounded, by Jury's conditions."""
    a, b, c, d = map(float, step.flat)
    trace, det = a + d, a * d - b * c
    slack = 1e-12 * (1.0 + abs(trace) + abs(det))
    return det <= 1.0 + slack and 1.0 + trace + det >= -slack and 1.0 - trace + det >= -slack


@dataclass(frozen=True, slots=True)
class Told:
    """How an engine is told of friction that is more than one level, with the words that are used.

    engine : as commands name it. static : f_s above f_k. stribeck : a level that falls with the sliding speed.
    polynomial : c_2 u|u| + c_3 u^3 of the sliding speed u. by : what it is said with.
    """

    engine: str
    static: str
    stribeck: str
    polynomial: str
    by: str


WORD, SET, FORCE = "its own word", "set in each step", "a force"
TOLD = (
    Told(
        "mujoco",
        SET,
        SET,
        WORD,
        "frictionloss by a callback of passive forces; damping of three numbers (contact: a force)",
    ),
    Told("pybullet", SET, SET, FORCE, "force of the velocity motor; lateralFriction"),
    Told("dart", SET, SET, FORCE, "setCoulombFriction"),
    Told(
        "rapier", SET, SET, FORCE, "frictionloss of the file, so a new world for each level; friction of the colliders"
    ),
    Told("drake", SET, SET, FORCE, "CoulombFriction of both surfaces, which are assigned anew"),
    Told("physx", WORD, SET, FORCE, "staticFrictionEffort and dynamicFrictionEffort; its viscous part is linear"),
    Told("newton", SET, SET, FORCE, "joint_friction, and notify_model_changed"),
    Told("mjx", SET, SET, FORCE, "dof_frictionloss in the scan; its own polynomials are dropped without a word"),
    Told("warp", SET, SET, FORCE, "dof_frictionloss in a kernel of its own before the step"),
)
"""On the law route all three are one force."""

STIFFNESS, STEP, MASS, DAMPING = 4500.0, 4e-3, 1.0, 20.0
"""A robot's servo: N/m, s, kg, N s/m."""


@dataclass(frozen=True, slots=True)
class Silent:
    """A word of friction that an engine takes and does not act on; engine : with its version."""

    engine: str
    what: str


WITHOUT_EFFECT = (
    Silent("Newton 1.8.0", "joint friction in SolverFeatherstone, SolverSemiImplicit, SolverXPBD and SolverVBD"),
    Silent("Rapier 0.36.1", "the coefficient of a collider that is given anew while a contact lasts"),
    Silent("Rapier 0.36.1", "contact friction along x of a box whose rotations and y are locked"),
    Silent("PhysX (ovphysx 0.7.0)", "PhysxJointAxisAPI friction on a joint outside an articulation"),
    Silent("PhysX (ovphysx 0.7.0)", "a static effort below the dynamic one"),
    Silent("PyBullet 3.2.7", "joint friction of a URDF"),
    Silent("MuJoCo 4.0.0", "noslip_iterations on an elliptic cone without a y freedom"),
    Silent("MuJoCo 4.0.0", "a contact's solreffriction on a pyramidal cone"),
    Silent("MJX 3.17.0", "noslip_iterations; polynomials of a joint's damping and stiffness; springyield"),
    Silent("MJX 3.17.0", "damping and armature of a motor"),
    Silent(
        "SAPIEN 3.0.3",
        "joint.set_friction is a unitless coefficient times a joint force, and 0.05 when nothing is said",
    ),
)
"""As docs/fidelity.md has them; a test holds the two together."""


@dataclass(frozen=True, slots=True)
class Servo:
    """One way to compute a servo, in n sub-steps; own : by the engine's own drive, else a torque held over the step."""

    who: str
    n: int
    own: bool

    @property
    def false_damping(self) -> float:
        """What the scheme adds to the damping, N s/m, to first order: laws.implicit and laws.held."""
        if self.own:
            return STIFFNESS * STEP / self.n
        return -0.5 * STIFFNESS * STEP * (1.0 - 1.0 / self.n)

    @property
    def zeta(self) -> float:
        """The damping ratio that comes of it."""
        return (DAMPING + self.false_damping) / (2.0 * math.sqrt(STIFFNESS * MASS))


SERVOS = (
    Servo("torque held over the step; one sub-step, PGS, or enableExternalForcesEveryIteration off", 1, False),
    Servo("torque held over the step; Rapier and TGS as they ship", 4, False),
    Servo("the same with many iterations", 16, False),
    Servo("the engine's own drive, one implicit step (DART, PGS, MuJoCo discrete)", 1, True),
    Servo("the engine's own drive, sub-steps as they ship (Rapier, TGS)", 4, True),
)
