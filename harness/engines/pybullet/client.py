"""The pybullet module, loaded without the build stamp it prints; everything here imports it from this file."""

from logging import Logger, getLogger

from harness.core.quiet import quiet

log: Logger = getLogger("harness.engines.pybullet")

with quiet(log):
    import pybullet

__all__ = ["log", "pybullet"]
