"""MJX behind the interface of harness.engines.base."""

from importlib.util import find_spec

if find_spec("jax") is None or find_spec("mujoco.mjx") is None:
    # what is imported late, since it takes seconds
    raise ImportError("No module named 'mujoco.mjx'")

from harness.engines.mjx.engine import MjxEngine

__all__ = ["MjxEngine"]
