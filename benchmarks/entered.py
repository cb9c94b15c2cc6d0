"""Functions and files of the house that a diagnosis enters. ``python -m benchmarks.entered`` prints both, by room."""

import sys
from collections import Counter
from pathlib import Path
from types import FrameType

import harness

_ROOT = Path(harness.__file__).parent
_RECORDING = _ROOT.parent / "docs" / "example" / "rig.csv"


def entered() -> set[tuple[str, str]]:
    """File and name of each Python function of harness that is entered after the import, modules' own bodies apart."""
    seen: set[tuple[str, str]] = set()
    inside = str(_ROOT)

    def watch(frame: FrameType, event: str, _: object) -> None:
        code = frame.f_code
        if event == "call" and code.co_filename.startswith(inside) and code.co_name != "<module>":
            seen.add((code.co_filename, code.co_qualname))

    sys.setprofile(watch)
    try:
        harness.diagnose(_RECORDING, engines=())
    finally:
        sys.setprofile(None)
    return seen


if __name__ == "__main__":
    found = entered()
    named = {one for one in found if not one[1].endswith((">", ">.__init__"))}
    files = {name for name, _ in found}
    sys.stdout.write(f"{len(found)} functions ({len(named)} with a name) in {len(files)} files\n")
    rooms = Counter(Path(name).relative_to(_ROOT).parts[0] for name, _ in found)
    sys.stdout.writelines(f"{room:24} {count}\n" for room, count in rooms.most_common())
