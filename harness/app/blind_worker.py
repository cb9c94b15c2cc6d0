"""The sealed side of a proof: ``python -m harness.app.blind_worker`` reads recordings and writes verdicts.

It knows nothing but what comes in on standard input; harness.proof.blind is the other side.
"""

import ctypes
import io
import json
import os
import signal
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from typing import Any, BinaryIO

from harness.app.diagnose import answer
from harness.app.diagnose_options import DiagnoseOptions
from harness.app.reading import ReadOptions, read_as, spooled
from harness.core.errors import HarnessError
from harness.proof.seal import canonical
from harness.results.diagnosis import DiagnosisResult

EVIDENCE = 5
"""Names tried alone that a verdict keeps."""
OURS = "harness"

Diagnoser = Callable[[bytes, Sequence[str]], dict[str, Any]]


def diagnosed(recording: bytes, arguments: Sequence[str]) -> dict[str, Any]:
    """The verdict of ``harness diagnose - ARGUMENTS`` on a recording, without what no score needs."""
    options = _options(arguments)
    with spooled(io.BytesIO(recording)) as path:
        return compact(answer(read_as("-", path, options.reading), options))


def compact(result: DiagnosisResult) -> dict[str, Any]:
    """A harness.diagnosis/1 as a proof publishes it: no models, no settings, no files."""
    full = json.loads(result.model_dump_json(by_alias=True))
    kept = ("verdict", "statement", "baseline", "mechanisms", "refined", "attribution", "warnings")
    holdout = {name: value for name, value in full["holdout"].items() if name != "spans_s"}
    engines = {
        name: {key: block[key] for key in ("version", "baseline_rmse", "refined_rmse", "error")}
        for name, block in full["engines"].items()
    }
    noise = full["recording"]["noise"]
    rest = {"holdout": holdout, "engines": engines, "evidence": full["evidence"][:EVIDENCE], "noise": noise}
    return {name: full[name] for name in kept} | rest


def _options(arguments: Sequence[str]) -> DiagnoseOptions:
    """Options from ["--restoring", "none", ...]: how the machine is held, as the command takes it."""
    named = dict(zip(arguments[::2], arguments[1::2], strict=True))
    return DiagnoseOptions.chosen(ReadOptions(), **{name.removeprefix("--"): value for name, value in named.items()})


def diagnosers() -> Mapping[str, Diagnoser]:
    """Everybody who answers in a proof, by name."""
    return {OURS: diagnosed}


def answered(who: str, arguments: Sequence[str], recording: bytes) -> bytes:
    """The answer as it is hashed; what goes wrong is in it."""
    try:
        said = diagnosers()[who](recording, arguments)
    except HarnessError as error:
        said = {"verdict": "error", "error": str(error)}
    except Exception as error:
        said = {"verdict": "error", "error": f"internal error, {type(error).__name__}: {' '.join(str(error).split())}"}
    return canonical(said)


def serve(requests: BinaryIO, answers: BinaryIO) -> None:
    """Answer until standard input ends."""
    while line := requests.readline():
        head = json.loads(line)
        said = answered(head["who"], head["arguments"], requests.read(head["bytes"]))
        answers.write(b"%d\n" % len(said) + said)
        answers.flush()


def main() -> None:
    """Answers go to what was standard output; what libraries print goes nowhere."""
    with suppress(OSError, AttributeError):
        set_parent_death_signal = 1
        ctypes.CDLL(None).prctl(set_parent_death_signal, signal.SIGKILL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    answers = os.fdopen(os.dup(1), "wb")
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    serve(sys.stdin.buffer, answers)


if __name__ == "__main__":
    main()
