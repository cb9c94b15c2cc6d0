"""The page of a robot's joint in the engines."""

from collections.abc import Mapping
from typing import Any

from harness.show.report.section import Section
from harness.show.report.sources import MadeWith
from harness.show.report.verdict import Verdict


def joint_sections(result: Mapping[str, Any]) -> list[Section]:
    """Sections. result : JointRunResult.model_dump(by_alias=True) (harness.joint/1)."""
    first, *rest = result["conclusions"]
    paste = [result["paste"]["mjcf"], *result["paste"]["urdf"].splitlines()]
    return [
        Verdict(first, rest),
        Verdict("", paste, heading="What to paste into the model (MJCF; URDF with PyBullet's calls)"),
        MadeWith(result["machine"], result["files"], result["command"]),
    ]
