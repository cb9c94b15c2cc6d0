"""SAPIEN's joint friction: python benchmarks/words/sapien_words.py, in an interpreter that has sapien; prints JSON.

1 kg on a prismatic joint, pushed with -100 x, released at 0.5 m, 1 ms a step: turning points in m with the joint as it
is made and with its friction set to 0.
"""

import json

import sapien


def turns(friction: float | None) -> tuple[float, list[float]]:
    """The joint's friction, and the first six turning points."""
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    scene.set_timestep(1e-3)
    builder = scene.create_articulation_builder()
    root = builder.create_link_builder()
    root.set_joint_properties("fixed", [], sapien.Pose(), sapien.Pose())
    link = builder.create_link_builder(root)
    link.set_joint_properties("prismatic", [[-10.0, 10.0]], sapien.Pose(), sapien.Pose())
    link.set_mass_and_inertia(1.0, sapien.Pose(), [1.0, 1.0, 1.0])
    made = builder.build()
    for one in made.links:
        one.disable_gravity = True
    joint = made.active_joints[0]
    if friction is not None:
        joint.set_friction(friction)
    made.set_qpos([0.5])
    found: list[float] = []
    before = 0.0
    while len(found) < 6:
        q, v = float(made.get_qpos()[0]), float(made.get_qvel()[0])
        if before * v < 0.0:
            found.append(abs(q))
        before = v
        made.set_qf([-100.0 * q])
        scene.step()
    return float(joint.friction), found


if __name__ == "__main__":
    default, plain = turns(None)
    _, none = turns(0.0)
    print(json.dumps({"version": sapien.__version__, "default": default, "plain": plain, "none": none}))
