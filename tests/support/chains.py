"""Random open chains as MJCF: skew axes, joints away from the origin, several in one body, references, springs."""

import numpy as np


def chain(seed: int, gravity: tuple[float, float, float] = (0.0, 0.0, -9.81)) -> str:
    """Two to five bodies with one to three joints each, one of which a slide now and then."""
    random = np.random.default_rng(seed)

    def numbers(size: int, scale: float = 1.0) -> str:
        return " ".join(f"{value:.12g}" for value in scale * random.normal(size=size))

    text, close, count = "", "", 0
    for body in range(random.integers(2, 6)):
        text += f'<body name="b{body}" pos="{numbers(3, 0.4)}" quat="{numbers(4)}">'
        sides = random.uniform(0.05, 0.3, 3)
        inertia = " ".join(f"{(sides.sum() ** 2 - side**2) / 12:.12g}" for side in sides)
        text += f'<inertial pos="{numbers(3, 0.2)}" quat="{numbers(4)}" mass="{random.uniform(0.3, 3):.12g}"'
        text += f' diaginertia="{inertia}"/>'
        for _ in range(random.integers(1, 4)):
            kind = "slide" if random.uniform() < 0.2 else "hinge"
            text += (
                f'<joint name="j{count}" type="{kind}" axis="{numbers(3)}" pos="{numbers(3, 0.3)}" ref="{numbers(1)}"'
                f' springref="{numbers(1)}" stiffness="{random.choice([0.0, 5.0])}" damping="0.7" frictionloss="1.3"'
                f' armature="{random.uniform(0, 0.2):.12g}"/>'
            )
            count += 1
        close += "</body>"
    world = f"<worldbody>{text}{close}</worldbody>"
    force = " ".join(map(repr, gravity))
    return f'<mujoco><compiler angle="radian"/><option gravity="{force}"/>{world}</mujoco>'


LINK = (
    '<inertial><origin xyz="{at}" rpy="0.3 -0.2 0.9"/><mass value="{mass}"/>'
    '<inertia ixx="0.02" iyy="0.03" izz="0.025" ixy="0.002" ixz="-0.001" iyz="0.003"/></inertial>'
)


def urdf(seed: int) -> str:
    """A URDF of three to five links; visuals and collisions name meshes that are nowhere."""
    random = np.random.default_rng(seed)
    text = '<link name="l0"/>'
    shape = '<geometry><mesh filename="package://nowhere/mesh.dae"/></geometry>'
    for i in range(1, random.integers(4, 7)):
        at, origin, turn, axis = (" ".join(f"{x:.12g}" for x in random.normal(size=3)) for _ in range(4))
        kind = random.choice(["revolute", "continuous", "prismatic"])
        text += f'<link name="l{i}">{LINK.format(at=at, mass=random.uniform(0.5, 2.0))}'
        text += f"<visual>{shape}</visual><collision>{shape}</collision></link>"
        text += f'<joint name="j{i}" type="{kind}"><origin xyz="{origin}" rpy="{turn}"/><parent link="l{i - 1}"/>'
        text += f'<child link="l{i}"/><axis xyz="{axis}"/><limit lower="-9" upper="9" effort="9" velocity="9"/>'
        text += '<dynamics damping="0.4" friction="0.6"/></joint>'
    return f'<robot name="r"><transmission name="t"><joint name="j1"/></transmission>{text}</robot>'
