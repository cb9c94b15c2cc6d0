"""New recordings of machines with their answers, and what a search of one begins with."""

from collections.abc import Mapping
from dataclasses import replace
from io import BytesIO
from typing import Any

from harness.app.diagnose.options import DiagnoseOptions
from harness.app.diagnose.problem import prepared
from harness.app.shared.reading import read, spooled
from harness.core.recording import Recording
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.problem import Problem
from harness.diagnosis.search.long_recordings import shortened
from harness.kernels.solve import Scales
from harness.model.model import Restoring
from harness.proof.machines.kinds import FREE, GROUPS, Kind, plan
from harness.proof.machines.made import made


def drawn(seed: int, index: int, group: str, kinds: Mapping[str, Kind] = FREE) -> tuple[Recording, Mapping[str, Any]]:
    """A recording of a group and its answer, by the number of a draw alone. Raises SimulationError for none."""
    mains, controls, unknown, tables = (int(group == one) for one in GROUPS)
    (job,) = plan(list(kinds.values()), mains, controls, unknown, tables, seed * 1_000_003 + index)
    found = made(seed, replace(job, index=index), sums=False)
    with spooled(BytesIO(found.recording.encode())) as path:
        return read(path, DiagnoseOptions().reading), found.answer


def based(recording: Recording, truth: Mapping[str, Any]) -> tuple[Problem, Fit, Scales]:
    """The problem with what its user would say, and its base model's fit. Raises HarnessError."""
    return shortened(prepared(recording, asked_of(truth)).problem)


def asked_of(truth: Mapping[str, Any]) -> DiagnoseOptions:
    """What the user of a machine would say of its recording."""
    given = dict(zip(truth["options"][::2], truth["options"][1::2], strict=True))
    return DiagnoseOptions(restoring=Restoring(given.get("--restoring", "spring")), zero=given.get("--zero"))
