"""Drake (pydrake): a box that slides and lifts on a floor. Its joints have no dry friction as of 1.51."""

from collections.abc import Mapping
from typing import Any, ClassVar, final

from pydrake.geometry import Box, ProximityProperties, RoleAssign
from pydrake.math import RigidTransform
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction, DiscreteContactApproximation
from pydrake.multibody.tree import PrismaticJoint, SpatialInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from harness.core.errors import SimulationError
from harness.core.trajectory import Trajectory
from harness.engines.base import Route, Task
from harness.engines.joint_words import GRAVITY, coefficient
from harness.engines.stepping import Plan, Stepped, SteppedEngine

HALF = (0.1, 0.12, 0.06)
"""Half of the box's edges, as in models/, m."""
FLOOR = 100.0
"""Edge of the floor, m."""
SETTLED, MOST = 1e-13, 2000
"""m a step, steps: a box that sinks slower, or so long, has arrived at the depth at which it rests."""


@final
class DrakeBody(Stepped):
    """A slide and a lift joint in series with a box at their end, and a floor under it on the contact route.

    Its friction is smooth: it counts as sticking below 99.5 % of the limit, which is ten stiction tolerances.
    """

    sticks_below = 0.995

    def __init__(self, plan: Plan, settings: dict[str, Any]) -> None:
        slider, self._rubs = plan.task.scenario.slider, plan.task.route == "contact"
        self._slider, self._dt, self._steps, self._normal = slider, plan.dt, 0, 0.0
        self._sign = 0.0
        builder = DiagramBuilder()
        plant, scene = AddMultibodyPlantSceneGraph(builder, plan.dt)
        carriage = plant.AddRigidBody("carriage", SpatialInertia.Zero())
        box = plant.AddRigidBody("box", SpatialInertia.SolidBoxWithMass(slider.m, *(2.0 * half for half in HALF)))
        world = plant.world_frame()
        self._slide = plant.AddJoint(PrismaticJoint("slide", world, carriage.body_frame(), [1.0, 0.0, 0.0]))
        self._lift = plant.AddJoint(PrismaticJoint("lift", carriage.body_frame(), box.body_frame(), [0.0, 0.0, 1.0]))
        self._box = box.index()
        if self._rubs:
            chosen = getattr(DiscreteContactApproximation, settings["contact_approximation"])
            plant.set_discrete_contact_approximation(chosen)
            surface = CoulombFriction(0.0, 0.0)
            edges = [2.0 * half for half in HALF]
            self._surfaces = [
                plant.RegisterCollisionGeometry(body, RigidTransform([0.0, 0.0, z]), shape, "surface", surface)
                for body, z, shape in ((box, HALF[2], Box(*edges)), (plant.world_body(), -0.5, Box(FLOOR, FLOOR, 1.0)))
            ]
        plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -GRAVITY if self._rubs else 0.0])
        plant.Finalize()
        if self._rubs:
            plant.set_stiction_tolerance(settings["stiction_tolerance"])
        self._plant, self._scene = plant, scene
        diagram = builder.Build()
        self._simulator = Simulator(diagram)
        root = self._simulator.get_mutable_context()
        self._context, self._scene_context = (part.GetMyMutableContextFromRoot(root) for part in (plant, scene))
        self._push = plant.get_applied_generalized_force_input_port().FixValue(self._context, [0.0, 0.0])
        self._touching = plant.get_contact_results_output_port()
        self._simulator.Initialize()
        if self._rubs:
            self._settle()
        self._slide.set_translation(self._context, plan.task.scenario.x0)
        self._slide.set_translation_rate(self._context, plan.first_speed)

    def _settle(self) -> None:
        """Let the box sink in place to where it rests."""
        z = 0.0
        for _ in range(MOST):
            before = z
            self.step(0.0)
            z = self._lift.get_translation(self._context)
            if abs(z - before) < SETTLED:
                break
        self._lift.set_translation_rate(self._context, 0.0)

    def limit(self, force: float) -> None:
        """See Stepped.limit; coefficients live in the properties of both surfaces, which are given anew."""
        mu = coefficient(self._slider, force)
        inspector = self._scene.model_inspector()
        for surface in self._surfaces:
            properties = ProximityProperties(inspector.GetProximityProperties(surface))
            # equal ones combine to themselves
            properties.UpdateProperty("material", "coulomb_friction", CoulombFriction(mu, mu))
            source = self._plant.get_source_id()
            self._scene.AssignRole(self._scene_context, source, surface, properties, RoleAssign.kReplace)

    def step(self, push: float) -> tuple[float, float, float]:
        self._push.GetMutableData().get_mutable_value().SetAtIndex(0, push)
        self._steps += 1
        self._simulator.AdvanceTo(self._steps * self._dt)
        context, slide = self._context, self._slide
        friction = self._contact() if self._rubs else 0.0
        return slide.get_translation(context), slide.get_translation_rate(context), friction

    def _contact(self) -> float:
        """Friction on the left-hand side of the step that was taken, N; keeps the normal force."""
        found = self._touching.Eval(self._context)
        if not found.num_point_pair_contacts():
            self._normal = 0.0
            return 0.0
        pair = found.point_pair_contact_info(0)
        if not self._sign:
            # the force is that on B, which stays B; on the floor it is friction on the left-hand side
            self._sign = -1.0 if pair.bodyB_index() == self._box else 1.0
        x, _, z = pair.contact_force().tolist()
        self._normal = abs(z)
        return float(self._sign * x)

    def floor(self) -> tuple[float, float]:
        return (self._lift.get_translation(self._context), self._normal) if self._rubs else (0.0, 0.0)


@final
class DrakeEngine(SteppedEngine):
    """Drake on a box and a floor (contact route), or on a joint that the clipped law rubs (law route)."""

    name: ClassVar[str] = "drake"
    package: ClassVar[str] = "drake"
    routes: ClassVar[tuple[Route, ...]] = ("contact", "law")
    shipped_dt: ClassVar[float] = 1e-3
    choices: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "contact_approximation": ("kLagged", "kTamsi", "kSimilar", "kSap")
    }

    def words(self, route: Route, shipped: bool, dt: float) -> dict[str, Any]:
        if route != "contact":
            return {}
        return {
            "contact_approximation": "kLagged" if shipped else "kTamsi",
            "stiction_tolerance": 1e-4 if shipped else 1e-8,
        }

    def body(self, plan: Plan, settings: dict[str, Any]) -> Stepped:
        return DrakeBody(plan, settings)

    def simulate(self, task: Task) -> Trajectory:
        try:
            return super().simulate(task)
        except RuntimeError as error:
            raise SimulationError(f"drake: {' '.join(str(error).split())[:300]}") from error
