"""MuJoCo Warp behind the interface of harness.engines.base."""

from importlib.util import find_spec

if find_spec("warp") is None or find_spec("mujoco_warp") is None:
    # what is imported late, since it takes seconds
    raise ImportError("No module named 'mujoco_warp'")

from harness.engines.warp.engine import WarpEngine

__all__ = ["WarpEngine"]
