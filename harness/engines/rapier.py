"""Rapier (rapier3d): a multibody joint with MJCF's frictionloss, or a box that slides and lifts."""

from collections.abc import Mapping
from typing import Any, ClassVar, final

import rapier3d
from rapier3d.loaders import mjcf

from harness.core.slider import Slider
from harness.engines.base import Route, Task
from harness.engines.joint_words import GRAVITY, coefficient
from harness.engines.stepping import SINGLE_PRECISION, Momentum, Plan, Stepped, SteppedEngine

HALF = (0.1, 0.12, 0.06)
"""Half of the box's edges, as in models/, m."""
FLOOR = 50.0
"""Half of the floor's edges, m."""
IGNORED = (
    SINGLE_PRECISION,
    "break-away: friction has one level; above sliding friction it is switched from outside when the force saturates",
)

_JOINT = """<mujoco><worldbody><body name="slider">
<joint name="slide" type="slide" axis="1 0 0" stiffness="{k!r}" damping="{c!r}" frictionloss="{f!r}"/>
<geom type="box" size="0.1 0.12 0.06" mass="{m!r}"/></body></worldbody></mujoco>"""


def _world(plan: Plan, settings: dict[str, Any], gravity: float) -> Any:
    world = rapier3d.PhysicsWorld(gravity=(0.0, 0.0, -gravity))
    given = world.integration_parameters
    given.dt = plan.dt
    given.num_solver_iterations = settings["num_solver_iterations"]
    given.num_internal_pgs_iterations = settings["num_internal_pgs_iterations"]
    if "friction_model" in settings:
        # a contact that is used again keeps its coefficient: one that was given anew would do nothing, without a word
        given.contact_recycling = False
        given.friction_model = getattr(rapier3d.FrictionModel, settings["friction_model"])
    return world


@final
class RapierJoint(Stepped):
    """A slider on a multibody joint; frictionloss is a word of the file alone, so another limit is another world."""

    def __init__(self, plan: Plan, settings: dict[str, Any]) -> None:
        slider, native = plan.task.scenario.slider, plan.native
        self._plan, self._settings = plan, settings
        self._k = slider.k if native.spring and plan.task.restoring == "spring" else 0.0
        self._c = slider.c if native.damping else 0.0
        self._momentum = Momentum(slider.m, self._c, self._k, plan.dt, max(1, settings["num_solver_iterations"]))
        self._q, self._speed = plan.task.scenario.x0, plan.first_speed
        self.limit(0.0)

    def limit(self, force: float) -> None:
        text = _JOINT.format(m=self._plan.task.scenario.slider.m, k=self._k, c=self._c, f=force)
        options = mjcf.MjcfLoaderOptions(make_roots_fixed=True, create_colliders_from_collision_shapes=False)
        robot, _ = mjcf.MjcfRobot.from_str(text, options)
        self._world = world = _world(self._plan, self._settings, 0.0)
        handles = robot.insert_using_multibody_joints(
            world.rigid_bodies, world.colliders, world.multibody_joints, world.impulse_joints
        )
        self._body = world.rigid_bodies[handles.bodies[-1].body]
        self._body.activation = rapier3d.RigidBodyActivation.cannot_sleep()
        self._joint = world.multibody_joints[handles.joints[0].joint].multibody
        # the fixed base counts until the first step
        base = [0.0] * (self._joint.ndofs - 1)
        self._joint.apply_displacements([*base, self._q])
        self._joint.set_generalized_velocity([*base, self._speed])
        self._limit = force

    def step(self, push: float) -> tuple[float, float, float]:
        """See Stepped.step; a force stays until it is taken away."""
        body, joint, q, speed = self._body, self._joint, self._q, self._speed
        body.reset_forces(True)
        body.add_force((push, 0.0, 0.0), True)
        self._world.step()
        self._q = joint.generalized_position()[-1]
        self._speed = after = joint.generalized_velocity()[-1]
        return self._q, after, self._momentum.friction(q, speed, after, push, self._limit)


@final
class RapierBox(Stepped):
    """A box that slides and lifts, on a floor; both have the same coefficient, which Rapier averages."""

    def __init__(self, plan: Plan, settings: dict[str, Any]) -> None:
        self._slider: Slider = plan.task.scenario.slider
        self._world = world = _world(plan, settings, GRAVITY)
        self._dt = plan.dt
        self._momentum = Momentum(self._slider.m, 0.0, 0.0, plan.dt, 1)
        bodies = rapier3d.RigidBodyBuilder
        floor = world.add_body(bodies(rapier3d.RigidBodyType.FIXED).translation((0.0, 0.0, -FLOOR)))
        start = (plan.task.scenario.x0, 0.0, HALF[2])
        # with its y locked too a box has no friction along x, without a word
        locked = rapier3d.LockedAxes.ROTATION_LOCKED
        made = bodies(rapier3d.RigidBodyType.DYNAMIC).translation(start).locked_axes(locked).can_sleep(False)
        box = world.add_body(made.linvel((plan.first_speed, 0.0, 0.0)))
        self._ground = world.add_collider(rapier3d.Collider.cuboid(FLOOR, FLOOR, FLOOR), floor)
        self._shape = world.add_collider(rapier3d.Collider.cuboid(*HALF).mass(self._slider.m), box)
        self._body = world.rigid_bodies[box]
        self._normal = self._mu = 0.0

    def limit(self, force: float) -> None:
        self._mu = coefficient(self._slider, force)
        for handle in (self._ground, self._shape):
            self._world.colliders[handle].friction = self._mu

    def step(self, push: float) -> tuple[float, float, float]:
        body, before = self._body, self._body.linvel.x
        body.reset_forces(True)
        body.add_force((push, 0.0, 0.0), True)
        self._world.step()
        pair = self._world.narrow_phase.contact_pair(self._ground, self._shape)
        found = [] if pair is None else [point.impulse for manifold in pair.manifolds for point in manifold.points]
        self._normal = sum(found) / self._dt
        after = body.linvel.x
        friction = self._momentum.friction(0.0, before, after, push, self._mu * self._normal)
        return body.translation.x, after, friction

    def floor(self) -> tuple[float, float]:
        return self._body.translation.z - HALF[2], self._normal


@final
class RapierEngine(SteppedEngine):
    """Rapier on one multibody joint (joint and law routes) or a box on a floor (contact route)."""

    name: ClassVar[str] = "rapier"
    package: ClassVar[str] = "rapier3d"
    shipped_dt: ClassVar[float] = 1.0 / 60.0
    choices: ClassVar[Mapping[str, tuple[str, ...]]] = {"friction_model": ("SIMPLIFIED", "COULOMB")}

    def words(self, route: Route, shipped: bool, dt: float) -> dict[str, Any]:
        """See SteppedEngine.words. own_spring : see own_or_pushed."""
        return {
            "num_solver_iterations": 4 if shipped else 1,
            "num_internal_pgs_iterations": 1,
            **({"friction_model": "SIMPLIFIED"} if route == "contact" else {"own_spring": shipped}),
        }

    def body(self, plan: Plan, settings: dict[str, Any]) -> Stepped:
        return RapierBox(plan, settings) if plan.task.route == "contact" else RapierJoint(plan, settings)

    def ignored(self, task: Task, settings: dict[str, Any]) -> tuple[str, ...]:
        return IGNORED
