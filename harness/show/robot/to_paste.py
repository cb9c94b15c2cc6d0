"""What is to be put into the user's model, as text to copy."""

from collections.abc import Mapping, Sequence

from harness.show.report.section import Section


def to_paste_section(paste: Mapping[str, str], left_out: Sequence[str] = ()) -> Section:
    """paste : the texts for MJCF and for URDF. left_out : what those formats have no word for, a sentence each."""
    dynamics, _, calls = paste["urdf"].partition("\n")
    texts = {"MJCF, in the joint's element": paste["mjcf"], "URDF, in the joint's element": dynamics}
    if calls:
        texts["PyBullet, for what it does not read of a URDF"] = calls
    return Section("What to paste into the model", "paste.html.j2", {"texts": texts, "left_out": list(left_out)})
