"""Puts a finished full proof where it is published: ``python -m benchmarks.publish proof DIR``.

A proof on other recordings than the first one's goes to a folder of its own: proof-machines, proof-paths, proof-real.
"""

import shutil
from pathlib import Path

from harness.app.prove.store import PAGE, RESULT, VERDICTS
from harness.app.prove.verify import verify_proof
from harness.core.errors import HarnessError
from harness.proof.seal import LEDGER
from harness.results.prove import ProofResult
from harness.show.report.page import share

LARGEST = 10_000_000
"""Bytes of everything that is published; recordings are not, they follow from the seed."""


def place_of(proof: Path) -> Path:
    """Where a finished proof is published; raises HarnessError for a folder that holds none."""
    try:
        sizes = ProofResult.model_validate_json((proof / RESULT).read_text(encoding="utf-8")).sizes
    except (OSError, ValueError):
        raise HarnessError(f"{proof} holds no finished proof; expected the folder of one") from None
    if sizes.singles:
        return Path("reports/proof")
    return Path("reports", "proof-real" if sizes.real else "proof-paths" if sizes.paths else "proof-machines")


def publish(proof: Path, into: Path) -> int:
    """Copy transcript, result, page and verdicts of a proof to ``into``, in place of what is there; returns bytes.

    Raises HarnessError when the proof is no evidence, is too large, or does not verify (with a sample of its recordings
    drawn again); then ``into`` stays as it is.
    """
    check = verify_proof(proof, short=True)
    if not check.accepted:
        raise HarnessError(f"{proof} is rejected: {'; '.join(check.wrong)}; nothing was published")
    if not ProofResult.model_validate_json((proof / RESULT).read_text(encoding="utf-8")).evidence:
        raise HarnessError(f"{proof} has too few recordings to be evidence; nothing was published")
    files = [proof / LEDGER, proof / RESULT, proof / PAGE, *sorted((proof / VERDICTS).glob("*.jsonl.gz"))]
    size = sum(file.stat().st_size for file in files)
    if size > LARGEST:
        raise HarnessError(f"the proof would take {size} bytes, more than {LARGEST}; nothing was published")
    shutil.rmtree(into, ignore_errors=True)
    (into / VERDICTS).mkdir(parents=True)
    for file in files:
        shutil.copyfile(file, into / file.relative_to(proof))
    share(proof / PAGE, into / PAGE)
    return size
