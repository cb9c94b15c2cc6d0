"""What is said where an engine that is usually taken cannot be had."""

from harness.engines import registry


def left_out() -> tuple[str, ...]:
    """A sentence for each engine that is usually taken and that this Python cannot have."""
    return tuple(
        f"{name} is left out: it has no wheel for this Python; harness doctor says what to do"
        for name in registry.USUAL
        if name not in registry.usual()
    )
