"""PyBullet behind the interface of harness.engines.base."""

from harness.engines.pybullet.engine import PybulletEngine

__all__ = ["PybulletEngine"]
