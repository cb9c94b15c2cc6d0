"""Inertias of a URDF that are no body's, made those of the nearest one, as other readers of URDF take them as they are.

A body's principal moments are above zero, and none is more than the sum of the others.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from lxml import etree

from harness.core.arrays import FloatArray

_PARTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
_LEAST = 1e-4
"""Of the largest principal moment: a rod of that much has a hundredth of its length for a radius."""
_ROUNDING, _NONE = 1e-6, 1e-9
"""Of the same: what decimals of a file leave, and what is none."""
_SAID = 3
"""Names in one sentence."""


def repaired(root: Any) -> list[str]:
    """Put bodies' inertias into the links of a tree; a sentence where there were others."""
    names, most = [], 0.0
    for link in root.findall("link"):
        for inertial in link.findall("inertial"):
            element = inertial.find("inertia")
            if element is None:
                element = etree.SubElement(inertial, "inertia", dict.fromkeys(_PARTS, "0"))
            try:
                values = dict(zip(_PARTS, (float(element.get(name, "0")) for name in _PARTS), strict=True))
            except ValueError:
                continue  # the compiler says what is wrong
            tensor = np.array(
                [[values["".join(("i", *sorted((a, b))))] for b in "xyz"] for a in "xyz"], dtype=np.float64
            )
            if not np.all(np.isfinite(tensor)):
                continue
            nearest = of_a_body(tensor)
            change = float(np.max(np.abs(nearest - tensor)))
            if change > _ROUNDING * float(np.max(np.abs(tensor))):
                names.append(link.get("name") or "without a name")
                most = max(most, change)
            if change > 0.0:
                for name in _PARTS:
                    element.set(name, repr(float(nearest["xyz".index(name[1]), "xyz".index(name[2])])))
    if not names:
        return []
    return [f"the inertia of {listed(names)} is that of no body: moments were raised, by {most:.2g} kg m^2 at most"]


def of_a_body(tensor: FloatArray) -> FloatArray:
    """The inertia (3, 3) of a body that has the largest principal moment of this one, kg m^2, and its axes."""
    power, axes = np.linalg.eigh(tensor)
    if power[2] <= 0.0:
        return tensor
    moments = np.where(power > _NONE * power[2], power, _LEAST * power[2])
    if (lack := moments[2] - moments[0] - moments[1]) > 0.0:
        moments[:2] += (lack + _NONE * moments[2]) / 2.0
    return np.asarray(tensor if np.array_equal(moments, power) else axes @ np.diag(moments) @ axes.T)


def listed(names: Sequence[str]) -> str:
    """Some names, and how many more."""
    more = len(names) - _SAID
    return ", ".join(names[:_SAID]) + (f" and {more} more" if more > 0 else "")
