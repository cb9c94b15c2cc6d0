"""Recordings that would decide between terms, in words that several of them share."""

from typing import Final

LARGER: Final = "a release from a larger displacement"
REST: Final = "a recording that starts before the release and goes on well after rest"
SLOW: Final = "a slow to-and-fro drive with the force recorded, so that it breaks away several times"
AGAIN: Final = "the same release repeated after a pause"
DRIVEN: Final = {
    LARGER: "a drive over a longer way",
    REST: "a drive that pauses, long enough to see where it stays",
    SLOW: SLOW,
    AGAIN: "the same drive repeated after a pause",
}
"""What stands for each of them where nothing is let go but a force drives."""
