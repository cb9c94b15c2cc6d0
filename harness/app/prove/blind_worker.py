"""The sealed side of a proof: ``python -m harness.app.prove.blind_worker`` reads recordings and writes verdicts.

It knows nothing but what comes in on standard input; harness.proof.blind is the other side.
"""

import ctypes
import io
import json
import os
import signal
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from harness.app.diagnose.change import change
from harness.app.diagnose.many import diagnose, diagnose_together
from harness.app.diagnose.one import answer
from harness.app.diagnose.options import DiagnoseOptions, RobotOptions, ServoOptions
from harness.app.shared.reading import ReadOptions, read_as, spooled
from harness.core.arrays import FloatArray
from harness.core.errors import HarnessError
from harness.proof.beside import R2, SINDY, SYSID
from harness.proof.paths.files import unpacked
from harness.proof.seal import canonical
from harness.proof.tally import OURS

EVIDENCE = 5
"""Names tried alone that a verdict keeps."""


def diagnosed(recording: bytes, arguments: Sequence[str]) -> dict[str, Any]:
    """The verdict of ``harness diagnose - ARGUMENTS`` on a recording, without what no score needs.

    Files that are packed in one are diagnosed as they lie, several together, or held against one another ("--before",
    "--after"); those that an argument names are what it says (a robot's model). No engine is asked then.

    arguments : as ("--restoring", "none", ...), how the machine is held.
    """
    named: dict[str, Any] = dict(zip((one.removeprefix("--") for one in arguments[::2]), arguments[1::2], strict=True))
    files = unpacked(recording)
    if files is None:
        held = {} if "restoring" in named else {"restoring": "spring", "zero": "spring"}
        options = _options({**named, **held})
        with spooled(io.BytesIO(recording)) as path:
            result = answer(read_as("-", path, options.reading), options)
    else:
        for name, text in files.items():
            Path(name).write_text(text, encoding="utf-8")
        sides = [
            [(Path(name), name) for name in named.pop(side, "").split(",") if name] for side in ("before", "after")
        ]
        options, out = _options({"engines": ()} | named), Path("answer")
        if all(sides):
            changed = change(sides[0], sides[1], options, out).model_dump(mode="json", by_alias=True)
            return {
                name: changed[name]
                for name in ("statement", "changed", "chance", "left", "numbers", "laws", "warnings")
            }
        recordings = [(Path(name), name) for name in files if name not in named.values()]
        if len(recordings) > 1:
            result = diagnose_together(recordings, options, out)
        else:
            result = diagnose(recordings[0][0], options, out)
    full = json.loads(result.model_dump_json(by_alias=True))
    kept = ("verdict", "statement", "baseline", "mechanisms", "refined", "attribution", "warnings")
    engines = {
        name: {key: block[key] for key in ("version", "baseline_rmse", "refined_rmse", "error")}
        for name, block in full["engines"].items()
    }
    noise = full["recording"]["noise"]
    rest = {
        "holdout": full["holdout"],
        "engines": engines,
        "evidence": full["evidence"][:EVIDENCE],
        "noise": noise,
        "posterior": full["posterior"],
    }
    arm = (full.get("robot") or {}).get("arm")
    if arm is not None:
        rest["found"] = [{key: one[key] for key in ("name", "joint", "grade", "rivals")} for one in arm["found"]]
    return {name: full[name] for name in kept} | rest


_OF_MODELS = ("robot", "joint", "sensor", "servo", "covariate")


def _options(named: Mapping[str, Any]) -> DiagnoseOptions:
    """Options by their names, as the command line has them."""
    files: dict[str, Any] = {name: Path(named[name]) for name in ("robot", "sim", "model") if name in named}
    if "covariate" in named:
        named = {**named, "covariates": named["covariate"].split(",")}
    named = {name: float(said) if name in ("mass", "horizon") else said for name, said in named.items()}
    robot = RobotOptions.chosen(files.pop("robot", None), joint=named.get("joint"), sensor=named.get("sensor"))
    if "model" in files:
        # an engine's own file has an engine to be asked
        named = {**named, "engines": ("mujoco",)}
    rest = {name: said for name, said in named.items() if name not in (*_OF_MODELS, *files)}
    servo = ServoOptions.chosen(named.get("servo"))
    return DiagnoseOptions.chosen(ReadOptions(), robot=robot, servo=servo, **files, **rest)


def by_baseline(who: str, recording: bytes, arguments: Sequence[str]) -> dict[str, Any]:
    """What a baseline names in the form of a verdict, or predicts.

    arguments : of one that predicts, the spans that our own verdict left out, as JSON.
    """
    if who == SYSID:
        from harness.proof.baselines.sysid import holdout_by_sysid

        return asdict(holdout_by_sysid(columns(recording), json.loads(arguments[0])))
    from harness.proof.baselines.regression import name_by_r2, name_by_sindy

    said = {R2: name_by_r2, SINDY: name_by_sindy}[who](columns(recording))
    verdict, named = "missing_physics" if said.names else "adequate", [{"name": name} for name in said.names]
    return {"verdict": verdict, "mechanisms": named, "applies": said.applies, "why": said.why}


def columns(recording: bytes) -> dict[str, FloatArray]:
    """The columns of a CSV recording by channel, shape (n,) each."""
    head, _, rest = recording.partition(b"\n")
    values = np.loadtxt(io.BytesIO(rest), delimiter=",", ndmin=2)
    names = [name.split()[0] for name in head.decode().split(",")]
    return {name: np.ascontiguousarray(values[:, i]) for i, name in enumerate(names)}


def answered(who: str, arguments: Sequence[str], recording: bytes) -> bytes:
    """The answer as it is hashed; what goes wrong is in it."""
    try:
        said = diagnosed(recording, arguments) if who == OURS else by_baseline(who, recording, arguments)
    except HarnessError as error:
        said = {"verdict": "error", "error": str(error)}
    except Exception as error:
        said = {"verdict": "error", "error": f"internal error, {type(error).__name__}: {' '.join(str(error).split())}"}
    return canonical(said)


def main() -> None:
    """Answer until standard input ends.

    Answers go to what was standard output; what libraries print goes nowhere.
    """
    with suppress(OSError, AttributeError):
        set_parent_death_signal = 1
        ctypes.CDLL(None).prctl(set_parent_death_signal, signal.SIGKILL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    requests, answers = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    while line := requests.readline():
        head = json.loads(line)
        said = answered(head["who"], head["arguments"], requests.read(head["bytes"]))
        answers.write(b"%d\n" % len(said) + said)
        answers.flush()


if __name__ == "__main__":
    main()
