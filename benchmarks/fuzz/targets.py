"""What the guided search calls: each reader with bytes of a file, and files to begin with."""

import json
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import chains
import joint_logs
import numpy as np
from hostile import BASE, MODEL, ROWS, mat, mat73, mat_packed, parquet
from mutations import TEXTS

from harness.app.shared.reading import read
from harness.app.sweep.regress import load_baseline
from harness.core.recording import Recording
from harness.io.columns import parse_columns
from harness.io.logs.read import read_joint_log
from harness.io.options import ReadOptions
from harness.io.recording import columns_of
from harness.io.units import parse_unit, split_header
from harness.model.document import load
from harness.proof.seal import Ledger
from harness.proof.verify import check_plan, check_transcript
from harness.robot.arm import load_arm

TABLE_TEXTS = (
    *TEXTS,
    *(b"t", b"x", b"v", b"a", b"u", b"time", b"Zeit", b"pos", b"acc", b"q", b"(", b")", b"ms", b"deg", b"[mm]", b"[g]"),
    *(b"1970", b"2024-01-01", b"1e9", b"NA", b"1,5", b"\xef\xbb\xbf", b"\xb5", b"t_s", b"x_rad", b"[lbf]", b"s^2"),
)
JSON_TEXTS = (
    *(b"{" * 5000, b"[" * 100_000, b"1e999", b"\\ud800", b"NaN", b"null", b"true", b"0", b"-1", b'""', b"[]", b"{}"),
    *(f'"{key}"'.encode() for key in ("terms", "name", "parameters", "base", "m", "k", "f_s", "internal", "variant")),
    *(b'"restoring"', b'"pendulum"', b'"stribeck"', b'"backlash"', b'"viscoelastic"', b'"cubic-stiffness"', b","),
)
XML_TEXTS = (
    *(b'<!DOCTYPE a [<!ENTITY b "c">]>', b"&b;", b"<include file='/etc/passwd'/>", b"<include file='../a.xml'/>"),
    *(b"<replicate count='1000000'><body/></replicate>", b"<joint type='ball'/>", b"<freejoint/>", b"nan", b"1e400"),
    *(b"<geom type='mesh' mesh='m'/>", b"<asset><mesh name='m' file='/etc/passwd'/></asset>", b"<body>", b"</body>"),
    *(b"<?xml version='1.0' encoding='utf-16'?>", b"\x00", b"'", b'"', b"<", b"-1", b"0", b"<tendon/>", b"<robot>"),
    *(b"<composite type='cable' count='9999999'/>", b"<plugin plugin='a'/>", b"<default/>", b"<mimic joint='j1'/>"),
)
_SIGNS = "t x v a u = * , [ ] #1 #0 1e308 - ( ) ** ^2 m mm deg ' \" ² µ / s lbf % degC"
EXPRESSIONS = (*(sign.encode() for sign in _SIGNS.split()), b"9" * 60, b" ")


@dataclass(frozen=True, slots=True)
class Target:
    """A reader.

    call : reads a file. seeds : bytes to begin with. suffix : of the file. texts : what is inserted. apart : whether
    the program reads it in a process of its own, which may crash and run out of memory; ``whole`` then is the way
    that the program takes.
    """

    call: Callable[[Path], object]
    seeds: tuple[bytes, ...]
    suffix: str
    texts: tuple[bytes, ...] = ()
    apart: bool = False

    def whole(self, path: Path) -> object:
        """As the program reads it."""
        return (checked if self.apart else self.call)(path)


def checked(path: Path) -> None:
    """A recording holds what one promises."""
    found = read(path, ReadOptions())
    assert isinstance(found, Recording)
    assert len(found) >= 50
    assert all(np.all(np.isfinite(values)) for values in (found.t, *found.channels.values()))


def expression(path: Path) -> None:
    """The first line of a file as --columns, the second as a header."""
    first, _, second = path.read_bytes().decode(errors="replace").partition("\n")
    parse_columns(first)
    _, unit = split_header(second)
    for channel in "txvau":
        if unit is not None:
            assert np.isfinite(parse_unit("fuzzed", channel, unit).factor)


def transcript(path: Path) -> None:
    """The transcript of a proof."""
    ledger = Ledger.load(path.parent)
    assert all(line.isprintable() for line in check_transcript(ledger) + check_plan(ledger))


def made(make: Callable[[Path], object], suffix: str) -> bytes:
    """The bytes of a valid file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"valid{suffix}"
        make(path)
        return path.read_bytes()


def tables() -> tuple[bytes, ...]:
    """Small tables of every layout."""
    rows = "\n".join(ROWS[1:62])
    heads = ("t,x", "t [ms],x [mm],F [lbf]", "t;x", "t x [deg] v", "# t x", "Zeit [s]\tWeg [µm]", "", "time,pos,acc")
    found = []
    for head in heads:
        separator = next((c for c in ";\t," if c in head), " ")
        found.append(f"{head}\n{rows.replace(',', separator)}\n".encode())
    decimal = "\n".join(row.replace(",", ";").replace(".", ",") for row in ROWS[1:62])
    return (*found, f"t;x\n{decimal}\n".encode())


def npz(path: Path) -> None:
    t = np.arange(60) / 50.0
    np.savez(path, t=t, x=np.cos(9.0 * t))


def mapped(path: Path) -> object:
    return columns_of(path, "", {})


def logs() -> tuple[bytes, ...]:
    motion = joint_logs.motion(n=60, rate=20.0)
    patterns = ("{joint}.{kind}", "{kind}[{i}]", "/{joint}/{kind}", "{kind}_{n}", "q{n}")

    def log(pattern: str) -> Callable[[Path], object]:
        return lambda path: joint_logs.csv(path, {"t": motion.t, **motion.columns(pattern)})

    return tuple(made(log(pattern), ".csv") for pattern in patterns)


DOCUMENT = MODEL | {
    "base": BASE | {"f_s": 4.0},
    "restoring": "pendulum",
    "terms": [{"name": "cubic-stiffness", "parameters": {"k3": 1.0}}, {"name": "viscoelastic"}],
}
STEP = {"step": "seed committed", "content": {"commitment": "0", "sizes": {}}, "before": "", "hash": "0"}
LEDGER = {"schema": "harness.proof-transcript/1", "entries": [STEP]}
BASELINE = {"schema": "harness.baseline/1", "rows": []}
TARGETS: dict[str, Target] = {
    "table": Target(checked, tables(), ".csv", TABLE_TEXTS),
    "expression": Target(
        expression, (b"t=t,x=qm*2[mm]\nx [mm]", b"x=#1[deg],u='a b'*-2e3[N]\nF (lbf)"), ".e", EXPRESSIONS
    ),
    "model": Target(load, (json.dumps(DOCUMENT).encode(), json.dumps(MODEL).encode()), ".json", JSON_TEXTS),
    "log": Target(read_joint_log, logs(), ".csv", TABLE_TEXTS),
    "robot": Target(load_arm, (chains.chain(0).encode(), chains.urdf(1).encode()), ".xml", XML_TEXTS),
    "transcript": Target(transcript, (json.dumps(LEDGER).encode(),), ".json", JSON_TEXTS),
    "baseline": Target(load_baseline, (json.dumps(BASELINE).encode(),), ".json", JSON_TEXTS),
    "npz": Target(mapped, (made(npz, ".npz"),), ".npz", apart=True),
    "mat": Target(mapped, (made(mat, ".mat"), made(mat_packed, ".mat"), made(mat73, ".mat")), ".mat", apart=True),
    "parquet": Target(mapped, (made(parquet, ".parquet"),), ".parquet", apart=True),
}
NAMES = {"transcript": "transcript.json"}
"""Files that are found by their name; others are ``fuzzed`` with their suffix."""
