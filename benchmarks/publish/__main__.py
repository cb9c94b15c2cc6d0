"""``python -m benchmarks.publish proof DIR | fidelity [NAME@PYTHON ...] | machines DIR``: what reports/ holds, anew.

proof : a finished proof; one of machines alone to reports/proof-machines. fidelity : the whole matrix, with engines of
other interpreters. machines : what ``harness dataset machines`` left. Pages share one plotting library, reports/*.js.
"""

import shutil
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from benchmarks.publish import fidelity, proof
from harness.app.dataset import FILES
from harness.core.errors import HarnessError
from harness.show.report.page import share

REPORTS = Path("reports")


def _proof(folders: Sequence[str]) -> str:
    folder = _one(folders)
    into = proof.place_of(folder)
    return f"{into}: {proof.publish(folder, into)} bytes"


def _fidelity(elsewhere: Sequence[str]) -> str:
    into = REPORTS / "fidelity"
    return f"{into}: {fidelity.publish(into, elsewhere)} bytes"


def _machines(folders: Sequence[str]) -> str:
    folder, into = _one(folders), REPORTS / "machines"
    into.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(folder / FILES["result"], into / FILES["result"])
    share(folder / FILES["page"], into / FILES["page"])
    return str(into)


def _one(folders: Sequence[str]) -> Path:
    if len(folders) != 1 or not Path(folders[0]).is_dir():
        raise HarnessError("expected one finished folder")
    return Path(folders[0])


ALL: dict[str, Callable[[Sequence[str]], str]] = {"proof": _proof, "fidelity": _fidelity, "machines": _machines}

if __name__ == "__main__":
    try:
        if sys.argv[1:2] and sys.argv[1] in ALL:
            print(ALL[sys.argv[1]](sys.argv[2:]))
        else:
            raise HarnessError(f"expected {' or '.join(ALL)}, as in python -m benchmarks.publish proof DIR")
    except HarnessError as error:
        sys.exit(f"harness: {error}")
