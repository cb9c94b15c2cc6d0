"""Contacts of a body of a compiled scene: forces, shares of friction cones, how they slide, whose friction it is."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from harness.core.arrays import FloatArray
from harness.engines.mujoco.presets import CONES


@dataclass(frozen=True, slots=True)
class Touch:
    """A pair of geoms in contact: who sets its friction (rule), over the later half of a run its mean normal force, N,
    and the share of its friction cone that is used.

    friction : sliding (two directions), torsional (m), rolling (two, m).
    """

    own: str
    other: str
    condim: int
    friction: tuple[float, ...]
    rule: str
    normal: float
    use: float


@dataclass(slots=True)
class _Pair:
    condim: int
    friction: tuple[float, ...]
    force: float = 0.0
    used: float = 0.0


class Tally:
    """What the contacts of a body were like, moment by moment; all but ``last`` and ``strained`` is of the later half.

    bearers : bodies that are to hold it, any where empty. looks, touched : moments, and those in contact. last : time
    of the last contact with one of the bearers, s.
    """

    def __init__(self, model: Any, body: int, bearers: frozenset[int] = frozenset()) -> None:
        self._model, self._own, self._bearers = model, geoms_of(model, body), bearers
        self._pressed = self._strained = 0.0
        self._pairs: dict[tuple[int, int], _Pair] = {}
        self._slid = np.zeros(3)
        self.looks = self.touched = 0
        self.last = 0.0

    def look(self, data: Any, t: float, late: bool) -> None:
        """Add the contacts that there are."""
        pressed = borne = 0.0
        slid = np.zeros(3)
        for i, mine, other, _ in contacts(data, self._own):
            force = force_of(self._model, data, i)
            if force[0] <= 0.0:
                continue
            pressed += float(force[0])
            found = _Pair(int(data.contact.dim[i]), tuple(map(float, data.contact.friction[i])))
            use = _use(self._model, found, force)
            if not self._bearers or bearer_of(self._model, other) in self._bearers:
                borne += float(force[0])
                self._strained += float(force[0]) * _use(self._model, found, force, _TORSION)
            if late:
                pair = self._pairs.setdefault((mine, other), found)
                pair.force += float(force[0])
                pair.used += float(force[0]) * use
                slid += force[0] * _slip(self._model, data, i, mine, other)
        self._pressed += borne
        self.last = t if borne > 0.0 else self.last
        if late:
            self.looks += 1
            self.touched += pressed > 0.0
            self._slid += slid / pressed if pressed > 0.0 else 0.0

    @property
    def slip(self) -> float:
        return float(np.linalg.norm(self._slid)) / max(1, self.touched)

    @property
    def use(self) -> float | None:
        force = sum(pair.force for pair in self._pairs.values())
        return sum(pair.used for pair in self._pairs.values()) / force if force > 0.0 else None

    @property
    def strained(self) -> float | None:
        """Share of the friction cones that is used where the bearers hold it, over the whole run.

        Without rolling friction, of which whatever rolls takes all.
        """
        return self._strained / self._pressed if self._pressed > 0.0 else None

    @property
    def touches(self) -> tuple[Touch, ...]:
        """Those that press most first."""
        model = self._model

        def named(geom: int) -> str:
            body = model.body(model.geom_bodyid[geom]).name or "world"
            return str(model.geom(geom).name or f"a geom of {body}")

        return tuple(
            Touch(
                named(mine),
                named(other),
                pair.condim,
                pair.friction,
                _rule(model, mine, other),
                pair.force / max(1, self.looks),
                pair.used / pair.force,
            )
            for (mine, other), pair in sorted(self._pairs.items(), key=lambda one: -one[1].force)
        )


def geoms_of(model: Any, body: int) -> frozenset[int]:
    """Geoms of a body and of those on it."""
    below = {body}
    for child in range(body + 1, model.nbody):
        if int(model.body_parentid[child]) in below:
            below.add(child)
    return frozenset(g for g in range(model.ngeom) if int(model.geom_bodyid[g]) in below)


def bearer_of(model: Any, geom: int) -> int:
    """The body that a geom moves with: that which its own is welded to."""
    return int(model.body_weldid[model.geom_bodyid[geom]])


def contacts(data: Any, own: frozenset[int]) -> Iterator[tuple[int, int, int, float]]:
    """Contacts of these geoms with others: number, own geom, the other, and the sign with which the normal points away
    from the other."""
    for i, (first, second) in enumerate(data.contact.geom[: data.ncon].tolist()):
        if (first in own) != (second in own):
            yield (i, first, second, -1.0) if first in own else (i, second, first, 1.0)


def force_of(model: Any, data: Any, i: int) -> FloatArray:
    """Of a contact, in its frame: normal, sliding, torsional, rolling, N and N m, (6,)."""
    found = np.zeros(6)
    mujoco.mj_contactForce(model, data, i, found)
    return found


_TORSION = 4
"""condim of a contact without rolling friction."""


def _use(model: Any, pair: _Pair, force: FloatArray, most: int = 6) -> float:
    """Share of the friction cone that a force takes; of a pyramid, as MuJoCo has it, by the sum of its edges.

    most : condim up to which its parts count.
    """
    parts = min(pair.condim, most)
    shares = np.abs(force[1:parts]) / (np.array(pair.friction[: parts - 1]) * force[0])
    if not shares.size:
        return 0.0
    return float(np.sum(shares) if CONES[int(model.opt.cone)] == "pyramidal" else math.hypot(*shares))


def _slip(model: Any, data: Any, i: int, mine: int, other: int) -> FloatArray:
    """Speed of the own geom over the other at their contact, across the normal, m/s, (3,)."""
    place, normal = data.contact.pos[i], data.contact.frame[i, :3]

    def speed(geom: int) -> FloatArray:
        body = int(model.geom_bodyid[geom])
        turning, moving = data.cvel[body, :3], data.cvel[body, 3:]
        found: FloatArray = moving + np.cross(turning, place - data.subtree_com[model.body_rootid[body]])
        return found

    relative = speed(mine) - speed(other)
    across: FloatArray = relative - (relative @ normal) * normal
    return across


def _rule(model: Any, mine: int, other: int) -> str:
    """Whose friction a contact has."""
    bodies = [int(model.geom_bodyid[g]) for g in (mine, other)]
    if any({int(a), int(b)} == {mine, other} for a, b in zip(model.pair_geom1, model.pair_geom2, strict=True)):
        return "the pair's own"
    first, second = (int(model.geom_priority[g]) for g in (mine, other))
    if first == second:
        return "the larger of both geoms'"
    leading = 0 if first > second else 1
    return (
        f"that of {model.geom((mine, other)[leading]).name or model.body(bodies[leading]).name or 'world'}, by priority"
    )
