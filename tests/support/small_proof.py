"""What the tests of a proof share: its size, a diagnosis that is quick, and the files it leaves."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import prove_stub
import pytest

from harness.app.prove import prove
from harness.proof.plan import Sizes

STUB = (sys.executable, str(Path(prove_stub.__file__)))
SIZES = Sizes(2, 3, 0, 1)
VERDICTS = "verdicts/harness.jsonl.gz"
BASELINE = "verdicts/pysindy.jsonl.gz"


@contextmanager
def unchanged_sources() -> Iterator[None]:
    """Sources that seem the same throughout: somebody may be working on them while tests run."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(prove, "code_digest", lambda: "the same")
        yield
