"""Scenes of a body on a slope, a ball that rolls, and a pinch grip, as people write them."""

from pathlib import Path

import mujoco
import numpy as np

GRAVITY = 9.81


def slope(option: str = "", load: float = 0.5, mu: float = 0.5, condim: int = 3, shape: str = "") -> str:
    """A body on a level floor; gravity is tilted so that it asks for ``load`` of its friction."""
    geom = shape or 'type="box" size=".1 .1 .05" mass="1"'
    return f"""<mujoco>
  <option {option} gravity="{load * mu * GRAVITY!r} 0 -{GRAVITY}"/>
  <worldbody>
    <geom name="floor" type="plane" size="50 50 1" condim="{condim}" friction="{mu} .005 .0001"/>
    <body name="block" pos="0 0 .05"><freejoint/><geom {geom} condim="{condim}" friction="{mu} .005 .0001"/></body>
  </worldbody>
</mujoco>
"""


def ball(option: str = "", mu_r: float = 0.002, radius: float = 0.05, speed: float = 1.0) -> str:
    """A ball that rolls; mu_r in m."""
    geom = f'type="sphere" size="{radius}" mass="1" condim="6" friction="1 .005 {mu_r}"'
    return f"""<mujoco>
  <option {option}/>
  <worldbody>
    <geom type="plane" size="50 50 1" condim="6" friction="1 .005 {mu_r}"/>
    <body name="ball" pos="0 0 {radius}"><freejoint/><geom {geom}/></body>
  </worldbody>
  <keyframe><key name="rolling" qpos="0 0 {radius} 1 0 0 0" qvel="{speed} 0 0 0 {speed / radius} 0"/></keyframe>
</mujoco>
"""


def pinch(option: str = "", force: float = 10.0, shape: str = "box", mu: float = 1.0, contact: str = "") -> str:
    """Two fingers that press a body of 0.2 kg between them, each with ``force`` N."""
    size = {"box": ".02 .02 .02", "cylinder": ".02 .02", "sphere": ".02"}[shape]
    return f"""<mujoco>
  <option {option}/>
  <default><geom friction="{mu} .005 .0001"/></default>
  <worldbody>
    <body name="left" pos="-.03 0 .2">
      <joint name="l" type="slide" axis="1 0 0" damping="5"/>
      <geom name="left" type="box" size=".01 .02 .02" mass=".1"/>
    </body>
    <body name="right" pos=".03 0 .2">
      <joint name="r" type="slide" axis="-1 0 0" damping="5"/>
      <geom name="right" type="box" size=".01 .02 .02" mass=".1"/>
    </body>
    <body name="held" pos="0 0 .2"><freejoint/><geom name="held" type="{shape}" size="{size}" mass=".2"/></body>
  </worldbody>
  {contact}
  <actuator><motor joint="l"/><motor joint="r"/></actuator>
  <keyframe><key name="grip" qpos="0 0 0 0 .2 1 0 0 0" ctrl="{force} {force}"/></keyframe>
</mujoco>
"""


def written(folder: Path, text: str, name: str = "scene.xml") -> Path:
    """A file with this text."""
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def creep_of(path: Path, body: str, seconds: float = 2.0) -> float:
    """Mean speed of a body over the later half, m/s, by mj_step of the file itself."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    places, steps = [], round(seconds / model.opt.timestep)
    for _ in range(steps + 1):
        mujoco.mj_step(model, data)
        places.append(data.body(body).xipos.copy())
    half = steps // 2
    return float(np.linalg.norm(places[-1] - places[half]) / ((steps - half) * model.opt.timestep))
