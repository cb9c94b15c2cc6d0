"""The drawn spring of a robot description: which visuals it is made of, and how far it is stretched.

URDF has no spring. Visuals of the fixed link whose material is called "spring" are rings of the coil.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from lxml import etree

from harness.core.arrays import FloatArray

_THINNEST = 0.05


@dataclass(frozen=True, slots=True)
class Coil:
    """visuals : which of the fixed link's visuals are rings. anchor : left end, m. length : to the body at x = 0, m."""

    visuals: tuple[int, ...]
    anchor: float
    length: float

    @classmethod
    def of(cls, urdf: Path, fixed: str, body: str) -> "Coil | None":
        """The coil drawn in this file, None when there is none. Raises OSError when the file cannot be read."""
        root = etree.parse(str(urdf)).getroot()
        rings, places = [], []
        for index, visual in enumerate(root.xpath("link[@name=$name]/visual", name=fixed)):
            if visual.xpath("material/@name") == ["spring"]:
                rings.append(index)
                places.append(float(visual.xpath("string(origin/@xyz)").split()[0]))
        if not rings:
            return None
        boxes = root.xpath("link[@name=$name]/visual/geometry/box/@size", name=body)
        half = 0.5 * max((float(size.split()[0]) for size in boxes), default=0.0)
        anchor = min(places)
        return cls(tuple(rings), anchor, -half - anchor)

    def stretch(self, x: FloatArray) -> FloatArray:
        """Length over free length when the body is at ``x``; never turned inside out."""
        return np.maximum(1.0 + x / self.length, _THINNEST)
