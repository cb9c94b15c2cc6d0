"""Functions of a package are left as they are written, not compiled: what tests see is what is covered or changed.

As a plugin of pytest (``-p benchmarks.plain``) it takes the package from the environment variable HARNESS_PLAIN.
"""

import os
from collections.abc import Callable
from typing import Any


def plain(package: str) -> None:
    """Functions of a module, or of all modules of a package, are not compiled when they are imported after this."""
    from harness.core import jit

    compiled = jit.compiled

    def chosen(function: Callable[..., Any], **options: Any) -> Callable[..., Any]:
        inside = f"{function.__module__}.".startswith(f"{package}.")
        return function if inside else compiled(function, **options)

    jit.compiled = chosen  # type: ignore[assignment]


# before any conftest imports what is not to be compiled
if "HARNESS_PLAIN" in os.environ:
    plain(os.environ["HARNESS_PLAIN"])
