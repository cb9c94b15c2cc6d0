"""What is to be put into the user's model, as text to copy."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from harness.show.report.section import Section


@dataclass(frozen=True)
class ToPaste(Section):
    """paste : the texts for MJCF and for URDF. left_out : what those formats have no word for, a sentence each."""

    template: ClassVar[str] = "paste.html.j2"
    paste: Mapping[str, str]
    left_out: Sequence[str] = ()

    @property
    def title(self) -> str:
        """The heading."""
        return "What to paste into the model"

    def context(self) -> Mapping[str, Any]:
        """What the template shows."""
        dynamics, _, calls = self.paste["urdf"].partition("\n")
        texts = {"MJCF, in the joint's element": self.paste["mjcf"], "URDF, in the joint's element": dynamics}
        if calls:
            texts["PyBullet, for what it does not read of a URDF"] = calls
        return {"texts": texts, "left_out": list(self.left_out)}
