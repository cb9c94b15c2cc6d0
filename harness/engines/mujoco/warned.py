"""What MuJoCo warns of, caught: without a handler it goes to standard error and to a file in the working folder."""

from collections.abc import Iterator
from contextlib import contextmanager

import mujoco


@contextmanager
def warned() -> Iterator[list[str]]:
    """The warnings of the block, as they come."""
    found: list[str] = []
    previous = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(found.append)
    try:
        yield found
    finally:
        mujoco.set_mju_user_warning(previous)
