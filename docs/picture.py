"""Make docs/picture.png: the default run as the viewer shows it. ``python docs/picture.py`` in a checkout.

Needs a graphics driver; see harness.show.screenshot. Takes about half a minute.
"""

import io
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

from harness.core.writing import replacing
from harness.show.screenshot import take

MOMENT = 1.2
"""Time shown, s: far enough in for the engines to differ."""

MENU = 36
"""Height of the viewer's menu bar, pixels, cut off: it warns of the software driver."""


def main() -> int:
    """Run, look, crop, shrink, save; 1 when a view reports anything."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "run"
        command = [
            sys.executable,
            "-c",
            "from harness.cli.main import main; main()",
            "run",
            "--quiet",
            "--out",
            str(out),
        ]
        subprocess.run(command, check=True)
        shot = take(out / "trace.rrd", MOMENT)
    complaints = [f"{view}: {line}" for view, lines in shot.reports.items() for line in lines]
    if complaints:
        print("\n".join(complaints), file=sys.stderr)
        return 1
    picture = Image.open(io.BytesIO(shot.png)).convert("RGB")
    picture = picture.crop((0, MENU, picture.width, picture.height))
    with replacing(Path(__file__).with_name("picture.png")) as part, part.open("wb") as file:
        picture.save(file, format="PNG", optimize=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
