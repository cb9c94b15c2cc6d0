"""A user's own model of one joint, MJCF or URDF: as a slider, and as its own engine simulates it."""

from dataclasses import dataclass, field
from pathlib import Path

from harness.core.errors import InputError
from harness.engines.base import Settings
from harness.engines.registry import load
from harness.engines.simulator import EngineSimulator
from harness.model.model import Model, Restoring
from harness.robot.arm import load_arm
from harness.robot.reduction import reduced
from harness.robot.servo import loosened, looseness, words

_SUFFIXES = (".xml", ".mjcf", ".urdf")
_ONE = "a model of one joint is accepted (of a robot's: --robot FILE --joint NAME)"


@dataclass(frozen=True, slots=True)
class OwnModel:
    """slider : what the joint is, let go nowhere; its friction, damping and spring are the file's. engine : MuJoCo for
    an MJCF, PyBullet for a URDF. settings : of the engine, as the file has them. dt : its step, s.
    """

    file: str
    slider: Model
    engine: str
    dt: float
    settings: Settings = field(default_factory=dict)

    @property
    def simulator(self) -> EngineSimulator:
        """The engine as the file has it. Raises SimulationError where it is not installed."""
        return EngineSimulator(load(self.engine), "as-shipped", self.settings)


def is_own(path: Path) -> bool:
    """Whether a file is an MJCF or a URDF, by its name."""
    return path.suffix.lower() in _SUFFIXES


def own_model(path: Path) -> OwnModel:
    """Read a file, as ``load_arm`` does; raises InputError for several joints, and for a spring beside gravity."""
    arm = load_arm(path)
    if len(arm.joints) > 1:
        raise InputError(str(path), f"{len(arm.joints)} joints: {', '.join(arm.joints)}", _ONE)
    (joint,) = arm.joints
    own = reduced(arm, joint)
    hangs = own.gravity > 0.0 and not own.slides and not own.upright
    if hangs and own.spring > 0.0:
        raise InputError(f"{path}: joint {joint}", "a spring beside gravity", "a joint with one of the two is accepted")
    held = Restoring.PENDULUM if hangs else Restoring.SPRING if own.spring > 0.0 else Restoring.NONE
    k = own.gravity if hangs else own.spring
    friction, damping = float(arm.frictionloss[0]), float(arm.damping[0])
    slider = Model(own.moved, damping, k, friction, restoring=held)
    if path.suffix.lower() == ".urdf":
        engine = load("pybullet")
        return OwnModel(str(path), slider, engine.name, float(engine.presets("joint", "as-shipped")["dt"]))
    settings = loosened(words(arm, joint), looseness(arm, joint, own.moved))
    return OwnModel(str(path), slider, "mujoco", float(arm.model.opt.timestep), settings)
