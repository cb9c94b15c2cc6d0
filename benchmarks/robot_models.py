"""``python -m benchmarks.robot_models FOLDER ...``: how many models of robots in folders are read, and why not.

A model is a file whose tree begins with <mujoco>, <robot> or <sdf>, that has a hinge or a slide, and that no other one
there includes: what packages ship, as it lies there. Nothing of it is kept.
"""

import argparse
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from lxml import etree

from harness.core.errors import InputError
from harness.robot.arm import load_arm
from harness.robot.reduction import reduced

_SUFFIXES = (".xml", ".urdf", ".mjcf", ".sdf")
_MOVING = ("revolute", "continuous", "prismatic")


def main(argv: Sequence[str] | None = None) -> int:
    """A line for each model, then how many; exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.robot_models", description=__doc__)
    parser.add_argument("folder", type=Path, nargs="+")
    told = parser.parse_args(argv)
    count = Counter[str]()
    for folder in told.folder:
        for path in models(folder):
            name = path.relative_to(folder.resolve().parent)
            try:
                arm = load_arm(path)
                alone = sum(_alone(arm, joint) for joint in arm.joints)
                count.update(models=1, read=1, joints=len(arm.joints), alone=alone)
                print(f"{name}: {alone} of {len(arm.joints)} joints; {'; '.join(arm.notes)}", flush=True)
            except InputError as error:
                count.update(models=1)
                print(f"{name}: REFUSED {str(error).removeprefix(str(path)).removeprefix(': ')}", flush=True)
    print(f"{count['read']} of {count['models']} models read, {count['alone']} of {count['joints']} joints alone")
    return 0


def models(folder: Path) -> Iterator[Path]:
    """Of a folder and those in it, sorted."""
    trees = {path: tree for path in sorted(folder.resolve().rglob("*")) if (tree := _tree(path)) is not None}
    parts = {
        path.parent / (part.get("file") or "")
        for path, tree in trees.items()
        for tag in ("include", "model")
        for part in tree.iter(tag)
    }
    parts = {path.resolve() for path in parts}
    for path, tree in trees.items():
        if path not in parts and tree.tag in ("mujoco", "robot", "sdf") and _moves(path, tree, trees):
            yield path


def _tree(path: Path) -> Any:
    if path.suffix.lower() not in _SUFFIXES or not path.is_file():
        return None
    try:
        found = etree.parse(path).getroot()
    except etree.XMLSyntaxError:
        return None
    # what is to be made a URDF by a macro processor is none yet
    return None if any(str(one.tag).startswith("{") and one.prefix == "xacro" for one in found.iter()) else found


def _moves(path: Path, tree: Any, trees: dict[Path, Any]) -> bool:
    """Whether a tree, or one that it includes, has a hinge or a slide."""
    if tree.tag in ("robot", "sdf"):
        return any(joint.get("type") in _MOVING for joint in tree.iter("joint"))
    bodies = (one for one in tree.iter("joint") if one.getparent().tag == "body")
    if any(one.get("type", "hinge") in ("hinge", "slide") for one in bodies):
        return True
    parts = [(path.parent / (part.get("file") or "")).resolve() for part in tree.iter("include")]
    return any(part != path and part in trees and _moves(part, trees[part], trees) for part in parts)


def _alone(arm: Any, joint: str) -> bool:
    """Whether a joint has an equation of its own."""
    try:
        reduced(arm, joint)
    except InputError:
        return False
    return True


if __name__ == "__main__":
    sys.exit(main())
