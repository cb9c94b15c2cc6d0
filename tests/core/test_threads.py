"""One thread for small matrices, unless somebody asked for more."""

import os
import subprocess
import sys

ASK = """
import sys
import harness.cli.main as m
sys.argv = ["harness", "--version"]
try:
    m.main()
except SystemExit:
    pass
"""


def _told(**asked: str) -> str:
    free = {k: v for k, v in os.environ.items() if not k.endswith("_NUM_THREADS")}
    code = f"{ASK}import numpy, os\nprint(os.environ['OPENBLAS_NUM_THREADS'])"
    said = subprocess.run(
        [sys.executable, "-c", code], env={**free, **asked}, capture_output=True, text=True, check=True, timeout=60
    )
    return said.stdout.split()[-1]


def test_a_command_computes_in_one_thread() -> None:
    assert _told() == "1"


def test_what_was_asked_stays() -> None:
    assert _told(OPENBLAS_NUM_THREADS="2") == "2"
