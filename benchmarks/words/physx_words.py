"""PhysX's own words of joint friction in a stage, without the adapter: a program that prints JSON.

A box of 1 kg on a prismatic joint under a gravity of 2 m/s^2 along it, and friction of 3 N written as
PhysxJointAxisAPI has it: speed after 0.1 s, inside an articulation and outside of one; then what the joint keeps of a
static effort below the dynamic one, both given anew.
"""

import json
import tempfile
from pathlib import Path

import numpy as np
import ovphysx
import ovstage
from ovphysx.types import TensorType

from harness.engines.physx_world import PhysxHere

STAGE = """#usda 1.0
(
    defaultPrim = "World"
    metersPerUnit = 1
    kilogramsPerUnit = 1
    upAxis = "Z"
)
def Xform "World"
{
    def PhysicsScene "scene" (
        prepend apiSchemas = ["PhysxSceneAPI"]
    )
    {
        vector3f physics:gravityDirection = (1, 0, 0)
        float physics:gravityMagnitude = 2
        uniform token physxScene:broadphaseType = "MBP"
        bool physxScene:enableGPUDynamics = 0
    }
    def Xform "slider" ROOT
    {
        def Xform "rail" (
            prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]
        )
        {
            float physics:mass = 1
            float3 physics:diagonalInertia = (1, 1, 1)
        }
        def Xform "box" (
            prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]
        )
        {
            float physics:mass = 1
            float3 physics:diagonalInertia = (1, 1, 1)
        }
        def PhysicsFixedJoint "root"
        {
            rel physics:body1 = </World/slider/rail>
        }
        def PhysicsPrismaticJoint "slide" (
            prepend apiSchemas = ["PhysxJointAxisAPI:linear"]
        )
        {
            rel physics:body0 = </World/slider/rail>
            rel physics:body1 = </World/slider/box>
            uniform token physics:axis = "X"
            float physxJointAxis:linear:staticFrictionEffort = 3
            float physxJointAxis:linear:dynamicFrictionEffort = 3
        }
    }
}
"""
ROOT = """(
        prepend apiSchemas = ["PhysicsArticulationRootAPI", "PhysxArticulationAPI"]
    )"""


def run(root: str) -> tuple[float, list[float]]:
    """Speed of the box after 0.1 s, m/s; static, dynamic and viscous after (3, 3, 0) and then (2, 3, 0) were given."""
    physics, stage = ovphysx.PhysX(), ovstage.Stage("words")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "words.usda"
        file.write_text(STAGE.replace("ROOT", root), encoding="utf-8")
        ovstage.population.open_usd(stage, str(file), ordinal=1, domains=ovstage.PopulationDomain.ALL)
    stage.advance_write_floor(ordinal=1).wait()
    physics.wait_task(physics.attach_ovstage(stage, read_ordinal=1))
    speed = physics.create_tensor_binding("/World/slider/box", tensor_type=TensorType.RIGID_BODY_VELOCITY)
    for _ in range(100):
        physics.step_sync(1e-3)
    found = np.zeros((1, 6), dtype=np.float32)
    speed.read(found)
    kept = np.zeros((1, 1, 3), dtype=np.float32)
    if root:
        friction = physics.create_tensor_binding(
            "/World/slider", tensor_type=TensorType.ARTICULATION_DOF_FRICTION_PROPERTIES
        )
        for static in (3.0, 2.0):
            friction.write(np.array([[[static, 3.0, 0.0]]], dtype=np.float32))
        friction.read(kept)
        friction.destroy()
    speed.destroy()
    physics.wait_task(physics.detach_ovstage())
    stage.destroy()
    physics.destroy()
    return found[0, 0].item(), kept.ravel().tolist()


if __name__ == "__main__":
    PhysxHere()  # no GPU, no threads, the schemas
    inside, kept = run(ROOT)
    outside, _ = run("")
    print(json.dumps({"inside": inside, "outside": outside, "kept": kept}))
