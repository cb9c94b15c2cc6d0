"""MuJoCo behind the interface of harness.engines.base."""

from harness.engines.mujoco.engine import MujocoEngine

__all__ = ["MujocoEngine"]
