"""The diagnosing process sees a recording and nothing else: who looks for answers finds none."""

import json
import os
import sys
import tempfile
from pathlib import Path

import prove_cheater
import pytest
from small_proof import VERDICTS

from harness.app.prove.prove import ProveOptions, prove
from harness.app.prove.store import published_verdicts
from harness.proof.blind import BlindProcess
from harness.proof.plan import Sizes
from harness.proof.seal import Ledger

pytestmark = pytest.mark.usefixtures("one_version")


def cheater(tmp_path: Path, out: Path) -> tuple[str, ...]:
    """The cheater with the places to look in."""
    places = [str(out), tempfile.gettempdir(), os.path.expanduser("~")]
    text = Path(prove_cheater.__file__).read_text().replace("PLACES: list[str] = []", f"PLACES = {places!r}")
    program = tmp_path / "diagnosis.py"
    program.write_text(text)
    return sys.executable, str(program)


def test_a_cheater_that_looks_everywhere_finds_no_answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # temporary files and a home of this proof alone: those of everybody else take longer to read than to write
    (tmp_path / "temporary").mkdir()
    (tmp_path / "home").mkdir()
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    monkeypatch.setenv("TMPDIR", str(tmp_path / "temporary"))
    out = tmp_path / "out"
    blind = cheater(tmp_path, out)
    prove(ProveOptions(Sizes(1, 0, 0, 0), jobs=1, baselines=(), blind=blind), out)
    verdicts = [json.loads(said) for said in published_verdicts(out / VERDICTS).values()]
    assert [verdict["mechanisms"] for verdict in verdicts] == [[]]
    assert all(int(verdict["statement"]) > 10 for verdict in verdicts)
    # the same cheater finds them as soon as they are opened: it can read
    answers = Ledger.load(out).content("opened")["answers"]
    process = BlindProcess(blind, {})
    try:
        for name, answer in answers.items():
            said = process.ask("harness", [], (out / "recordings" / f"{name}.csv").read_bytes(), 60.0)
            found = [guess["name"] for guess in json.loads(said)["mechanisms"]]
            assert {answer["value"]["mechanisms"][0], "seed"} <= set(found)
    finally:
        process.close()


@pytest.mark.parametrize(
    ("code", "why"),
    [
        ("raise SystemExit(1)", "it ends"),
        ("import sys; sys.stdin.buffer.readline(); print('no number', flush=True)", "it does not keep to the form"),
        ("import time; time.sleep(60)", "it takes too long"),
    ],
)
def test_a_process_that_does_not_answer_has_said_nothing(code: str, why: str) -> None:
    process = BlindProcess([sys.executable, "-c", code], {})
    try:
        assert process.ask("harness", [], b"t,x\n", 1.0 if "sleep" in code else 30.0) == b"", why
    finally:
        process.close()


def test_the_sealed_process_sees_an_empty_folder_and_nothing_that_tells(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ANSWER", "stribeck")
    code = (
        "import json, os, sys\n"
        "while line := sys.stdin.buffer.readline():\n"
        "    sys.stdin.buffer.read(json.loads(line)['bytes'])\n"
        "    said = json.dumps([os.listdir('.'), sorted(os.environ), len(os.listdir('/proc/self/fd')), os.getpid()])\n"
        "    open('left-behind', 'w').close()\n"
        "    print(len(said), said, sep='\\n', end='', flush=True)\n"
    )
    process = BlindProcess([sys.executable, "-c", code], {"CODE": "here"})
    try:
        first_said, second_said = (json.loads(process.ask("harness", [], b"t,x\n", 30.0)) for _ in range(2))
    finally:
        process.close()
    # what the first left behind is gone, and the process is the same
    assert first_said == second_said
    folder, names, descriptors, _ = first_said
    assert folder == []
    assert "ANSWER" not in names
    assert {"CODE", "HOME", "TMPDIR", "OMP_NUM_THREADS"} <= set(names)
    # the three standard ones and the one that lists them
    assert descriptors == 4
