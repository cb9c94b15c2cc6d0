"""One row in a worker process, of a local pool or of a cluster alike."""

import threading
from functools import cache
from typing import Any

from harness.core.errors import HarnessError
from harness.engines.base import Engine
from harness.fidelity.row import Spec, failed, run_row

_one_at_a_time = threading.Lock()
"""Engines speak through descriptors that belong to the process; a cluster's worker may have several threads."""


def compute(spec: Spec) -> dict[str, Any]:
    """The row of a spec as plain data; whatever goes wrong is in the row."""
    with _one_at_a_time:
        try:
            engine = _engine(spec.engine)
        except HarnessError as error:
            return failed(spec, str(error)).as_dict()
        found = engine.version()
        if found != spec.version:
            return failed(spec, f"this worker has {spec.engine} {found}, not {spec.version}").as_dict()
        return run_row(engine, spec).as_dict()


def failed_row(spec: Spec, why: str) -> dict[str, Any]:
    """The row of a spec that could not be computed."""
    return failed(spec, why).as_dict()


@cache
def _engine(name: str) -> Engine:
    from harness.engines.registry import load

    return load(name)
