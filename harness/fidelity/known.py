"""What is known of engines without a sweep: words that do nothing, and what a robot's servo makes of its damping."""

import math
from dataclasses import dataclass

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
