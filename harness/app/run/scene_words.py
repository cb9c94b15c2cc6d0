"""A body of a scene against dry friction, in sentences."""

from harness.results.scene import SceneMotion, SceneResult
from harness.show.numbers import number

_WHAT = {
    "slide": "slides",
    "spin": "spins about the contact's normal",
    "roll": "tilts or rolls",
    "lift": "lifts off",
}
_NOTHING = 1e-9
"""m/s, below which a speed is not written out."""
_STEADY = 1e-3
"""Of a speed, by which one that is kept may change in a run."""
_ALL = 0.95
"""Share of the friction cones from which on all of them is said to be in use."""
_POINT = 3
"""condim of a contact that has no torsional friction."""


def conclusions(result: SceneResult) -> list[str]:
    """What moved that dry friction would hold, what mends it, how the contacts get their friction."""
    said = [_answer(result), *_detail(result)]
    if result.moved:
        said += _mend(result)
    if result.moved and result.changed is None and result.moved != ["sparse"]:
        said.append("No option that was tried mends it; a smaller timestep or stiffer contacts (solref) may.")
    if "spin" in result.moved and any(one.condim <= _POINT for one in result.touches):
        said.append("Its contacts are points without torsional friction (condim 3): condim 4 holds a spin.")
    slippery = [one for one in result.touches if one.condim == 1]
    if slippery:
        pairs = ", ".join(dict.fromkeys(f"{one.own} on {one.other}" for one in slippery))
        said.append(f"Without friction, whatever its coefficient: {pairs} (condim 1).")
    rules = dict.fromkeys(
        f"{one.own} on {one.other}: friction {one.friction[0]:g}, condim {one.condim}, {one.rule}"
        for one in result.touches
    )
    return said + [f"Friction of {rule}." for rule in list(rules)[:4]]


def _answer(result: SceneResult) -> str:
    name, where = result.body, result.bearer
    if result.diverged_after is not None:
        return f"{name} diverges after {result.diverged_after} steps."
    if not result.touches and result.lost_s is None and result.expected.cone_use is None:
        return f"{name} touches nothing while it is watched: there is no friction to judge."
    if result.lost_s is not None or result.expected.lost_s is not None:
        return _let_go(result)
    if not result.expected.rests:
        does = "and so it would under dry friction"
        if "motion" in result.moved:
            does = f"where dry friction would have it at {_speed(result.expected.creep_m_s)}"
        return f"{name} moves along {where} at {_speed(result.creep_m_s)}, {does}."
    parts = [_WHAT[part] for part in result.moved if part in _WHAT]
    if not parts:
        return f"{name} rests on {where} as dry friction would have it (creep {_speed(result.creep_m_s)})."
    held = f"where dry friction would hold it{_use(result.expected)}"
    return f"{name} {_and(parts)} {held}: {_speed(result.creep_m_s)} along {where}."


def _let_go(result: SceneResult) -> str:
    """Of a body that leaves what holds it, under the file's options or under dry friction."""
    name, holders = result.body, _and(result.bearers or [result.bearer])
    own, exact = result.lost_s, result.expected.lost_s
    if own is not None and exact is None:
        held = f"where dry friction would hold it{_use(result.expected)}"
        return f"{name} is let go by {holders} {_after(own)}, {held}."
    asks = " It takes all the friction there is." if (result.expected.cone_use or 0.0) > _ALL else ""
    if own is None:
        return f"{name} stays with {holders}, where dry friction would let it go {_after(exact)}.{asks}"
    does = "and so it would" if "motion" not in result.moved else f"where it would {_after(exact)}"
    return f"{name} leaves {holders} {_after(own)}, {does} under dry friction.{asks}"


def _after(t: float | None) -> str:
    return "at once" if not t else f"after {t:.2g} s"


def _detail(result: SceneResult) -> list[str]:
    said = []
    if result.dense_differs_m is not None:
        off = f"{number(result.dense_differs_m * 1e3, 3)} mm"
        what = f"a dense Jacobian moves it by up to {off} elsewhere" if "sparse" in result.moved else (
            f"a dense Jacobian gives the same motion, to {off}"
        )  # fmt: skip
        said.append(f"MuJoCo {result.version} has a wrong Hessian for sparse Jacobians, which this scene uses: {what}.")
    own, exact = result.deceleration_m_s2, result.expected.deceleration_m_s2
    falls = result.lost_s is not None or result.expected.lost_s is not None
    if result.touches and not (result.expected.rests or falls) and own is not None and exact is not None:
        kind = "rolls" if result.slip_m_s < 0.1 * max(result.creep_m_s, 1e-9) else "slides"
        how = "slows down" if exact > 0.0 else "gains speed"
        if max(abs(own), abs(exact)) * result.duration_s < _STEADY * result.creep_m_s:
            said.append(f"It {kind} and keeps its speed.")
        else:
            said.append(f"It {kind} and {how} by {abs(own):.4g} m/s^2; under dry friction by {abs(exact):.4g} m/s^2.")
    if result.expected.rests and not falls and "slide" not in result.moved and result.travel_m > 1e-2:
        said.append(f"Before it rested it went {number(result.travel_m * 1e3, 3)} mm.")
    turns = [
        f"{'spins at' if part == 'spin' else 'tilts or rolls at'} {number(rate, 3)} rad/s"
        for part, rate in (("spin", result.spin_rad_s), ("roll", result.roll_rad_s))
        if part in result.moved
    ]
    if "lift" in result.moved:
        turns.append(f"lifts by {number(result.lift_m * 1e3, 3)} mm")
    if turns:
        said.append(f"It {_and(turns)}.")
    return said


def _mend(result: SceneResult) -> list[str]:
    said = []
    changed = result.changed
    if changed is not None:
        words = " ".join(f'{name}="{_value(value)}"' for name, value in changed.options.items())
        cost = result.steps_per_s / changed.steps_per_s
        does = "mends it" if changed.mends else "comes nearest"
        what = (
            f"creep {_speed(changed.creep_m_s)}"
            if result.expected.rests
            else f"lift {number(changed.lift_m * 1e3, 3)} mm"
            if result.moved == ["lift"]
            else f"{_speed(changed.creep_m_s)} against {_speed(result.expected.creep_m_s)}"
        )
        proof = " (the changed file was run)" if result.proved else ""
        said += [f"{words} {does}: {what}{proof}.", f"For that it costs {cost:.2g} times as much a step."]
    noslip = [one for one in result.tried if one.options.get("noslip_iterations", 0) and result.expected.rests]
    worse = [one for one in noslip if one.creep_m_s > result.creep_m_s or one.lost_s or one.diverged_after]
    if worse:
        cone = worse[0].options.get("cone", result.settings["cone"])
        said.append(f"noslip makes it worse with the {cone} cone: {_speed(worse[0].creep_m_s)}.")
    return said


def _use(motion: SceneMotion) -> str:
    return "" if motion.cone_use is None else f" ({100.0 * motion.cone_use:.2g} % of the friction available)"


def _speed(value: float) -> str:
    if abs(value) < _NOTHING:
        return "less than 0.001 µm/s"
    if abs(value) < 1e-3:
        return f"{number(value * 1e6, 3)} µm/s"
    return f"{number(value * 1e3, 3)} mm/s" if abs(value) < 1.0 else f"{number(value, 3)} m/s"


def _value(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def _and(parts: list[str]) -> str:
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}"
