"""Recordings of real machines in a folder, as its list and the published one name them."""

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

from harness.app.dataset.machines import Listed, at_hand, listed
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.shared.reading import read
from harness.core.errors import InputError
from harness.proof.drawing import AtHand
from harness.proof.real.measured import Measured, Rig

_TOLD = ("restoring", "zero", "mass", "horizon")
"""Options that are the diagnosis's; all others are the reader's."""


@lru_cache(maxsize=1)
def measured_in(folder: Path) -> tuple[AtHand, tuple[str, ...]]:
    """What lies in a folder, and the names of listed files that do not. Raises InputError."""
    # the last to list a file has its word
    every = {one.file: (one, options) for one, options in listed(folder)}
    there = at_hand(folder, list(every.values()))
    measured = {file: _read(there[file], *every[file]) for file in there}
    rigs = {
        file: one.rig(
            file, every[file][0].machine or every[file][0].name, every[file][0].condition, every[file][0].moves
        )
        for file, one in measured.items()
    }
    return AtHand(rigs, measured), tuple(file for file in every if file not in there)


def check_sealed(folder: Path, rigs: Sequence[Rig]) -> None:
    """Raises InputError for a recording that is not there as a transcript has it."""
    found = measured_in(folder)[0].rigs
    for rig in rigs:
        if rig.file not in found or found[rig.file].sha256 != rig.sha256:
            accepted = "the folder that the proof was begun with"
            raise InputError(f"--from {folder}", f"{rig.file} is not there, or not as it was sealed", accepted)


def _read(path: Path, one: Listed, options: DiagnoseOptions) -> Measured:
    found = read(path, options.reading)
    chosen = {name: str(one.options[name]) for name in _TOLD if name in one.options}
    if one.options.get("covariate"):
        chosen["covariate"] = ",".join(one.options["covariate"])
    return Measured(found.t, dict(found.channels), dict(found.covariates), found.angular, chosen)
