"""A robot's URDF in a world of PyBullet of its own."""

import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from harness.engines.pybullet import pybullet


@contextmanager
def opened(
    text: bytes, dt: float, refused: Callable[[str], Exception], **parameters: float
) -> Iterator[tuple[int, int, dict[str, int]]]:
    """Numbers of the world, of the robot in it, and of its joints by name.

    dt : s. refused : makes of PyBullet's message what is raised where it does not load the text. parameters : of the
    engine.
    """
    client = pybullet.connect(pybullet.DIRECT)
    try:
        pybullet.setPhysicsEngineParameter(enableFileCaching=0, fixedTimeStep=dt, physicsClientId=client, **parameters)
        with tempfile.TemporaryDirectory(prefix="friction-harness-") as folder:
            file, flags = Path(folder) / "robot.urdf", pybullet.URDF_USE_INERTIA_FROM_FILE
            file.write_bytes(text)
            try:
                body = int(pybullet.loadURDF(str(file), useFixedBase=True, flags=flags, physicsClientId=client))
            except pybullet.error as error:
                raise refused(f"PyBullet does not load it ({error})") from None
        joints = range(pybullet.getNumJoints(body, physicsClientId=client))
        yield client, body, {pybullet.getJointInfo(body, i, physicsClientId=client)[1].decode(): i for i in joints}
    finally:
        pybullet.disconnect(client)
