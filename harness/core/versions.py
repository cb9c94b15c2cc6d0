"""Versions of installed packages, each looked up once: the lookup reads a folder, and every run asks."""

from functools import cache
from importlib import metadata


@cache
def version(package: str) -> str:
    """Version of an installed package; raises importlib.metadata.PackageNotFoundError for one that is not."""
    return metadata.version(package)
