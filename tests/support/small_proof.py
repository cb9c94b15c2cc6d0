"""What the tests of a proof share: its size, a diagnosis that is quick, and the files it leaves."""

import sys
from pathlib import Path

import prove_stub

from harness.proof.plan import Sizes

STUB = (sys.executable, str(Path(prove_stub.__file__)))
SIZES = Sizes(2, 3, 0, 1)
VERDICTS = "verdicts/harness.jsonl.gz"
BASELINE = "verdicts/pysindy.jsonl.gz"
