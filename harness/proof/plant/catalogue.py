"""Names and families of what the plant can hide; the parameters by which a finding is judged."""

FAMILY = {
    "stribeck": "friction",
    "static-friction": "friction",
    "presliding": "friction",
    "regularised-friction": "friction",
    "position-dependent-friction": "friction",
    "friction-drift": "friction",
    "normal-load-variation": "friction",
    "quadratic-drag": "damping",
    "asymmetric-viscous": "damping",
    "power-law-damping": "damping",
    "viscoelastic": "damping",
    "cubic-stiffness": "stiffness",
    "quadratic-stiffness": "stiffness",
    "pendulum-stiffness": "stiffness",
    "end-stop": "stiffness",
    "backlash": "stiffness",
    "stiffness-drift": "stiffness",
    "constant-force": "environment",
    "force-ripple": "environment",
    "harmonic-force": "environment",
    "impulse": "environment",
    "attached-mode": "environment",
    "sensor-lag": "sensor",
    "sensor-gain": "sensor",
    "sensor-bias": "sensor",
    "sensor-drift": "sensor",
    "sensor-clipping": "sensor",
}
KINDS = tuple(FAMILY)

ALIENS = {
    "alien-inertial-load": ("friction",),
    "alien-structural-damping": ("friction", "damping"),
    "alien-heating": ("friction",),
    "alien-random-force": ("environment",),
    "alien-rattle": ("environment", "stiffness"),
    "alien-speed-stiffness": ("stiffness", "damping"),
}
"""Effects that no catalogue holds, with the families that would not be wrong."""

HEADLINE = {
    "stribeck": ("f_s", "v_s"),
    "static-friction": ("f_s",),
    "presliding": ("sigma0",),
    "regularised-friction": ("v_r",),
    "position-dependent-friction": ("slope",),
    "friction-drift": (),
    "normal-load-variation": ("Omega",),
    "quadratic-drag": ("c2",),
    "asymmetric-viscous": ("c_diff",),
    "power-law-damping": ("exponent",),
    "viscoelastic": ("tau",),
    "cubic-stiffness": ("k3",),
    "quadratic-stiffness": ("k2",),
    "pendulum-stiffness": (),
    "end-stop": ("gap",),
    "backlash": ("gap",),
    "stiffness-drift": ("rate",),
    "constant-force": ("force",),
    "force-ripple": ("period",),
    "harmonic-force": ("Omega",),
    "impulse": ("time",),
    "attached-mode": ("omega_2",),
    "sensor-lag": ("lag",),
    "sensor-gain": ("gain",),
    "sensor-bias": (),
    "sensor-drift": ("rate",),
    "sensor-clipping": (),
}

NEEDS = {
    "constant-force": "x",
    "sensor-drift": "x",
    "sensor-lag": "xa",
    "sensor-gain": "xa",
    "sensor-bias": "a",
    "sensor-clipping": "a",
}
"""Channels without which an effect does not show at all."""

ONE_OF = (
    frozenset({"presliding", "regularised-friction"}),
    frozenset({"stribeck", "static-friction"}),
    frozenset({"presliding", "static-friction"}),
    frozenset({"regularised-friction", "static-friction"}),
    frozenset({"regularised-friction", "stribeck"}),
    frozenset({"cubic-stiffness", "pendulum-stiffness"}),
)
"""Pairs that fill the same slot, or of which one takes away what the other acts on."""


def compatible(first: str, second: str) -> bool:
    """Whether two effects can be hidden in one recording."""
    return first != second and frozenset({first, second}) not in ONE_OF


def families(names: tuple[str, ...]) -> list[str]:
    """Families of the effects, in their order, each once."""
    found: list[str] = []
    for name in names:
        for family in ALIENS[name] if name in ALIENS else (FAMILY[name],):
            if family not in found:
                found.append(family)
    return found
