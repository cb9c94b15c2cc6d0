"""The published drive-axis files from where they are published, by the package that knows the place."""

from importlib import import_module
from pathlib import Path

from harness.core.errors import HarnessError, InputError


class DownloadError(HarnessError):
    """Nothing could be downloaded."""


def download_emps(into: Path) -> Path:
    """Download both files below ``into``, which is made; returns their folder. What is there is not fetched again.

    Raises InputError without the extra, DownloadError when the download fails. Nothing is checked here: the reader
    compares the files with the published ones.
    """
    try:
        fetch = import_module("nonlinear_benchmarks").EMPS
    except ModuleNotFoundError:
        accepted = "the extra is accepted: pip install 'friction-harness[emps]'; or --from with a folder of the files"
        raise InputError("--download", "the package nonlinear_benchmarks is not installed", accepted) from None
    try:
        into.mkdir(parents=True, exist_ok=True)
        files = [Path(file) for file in fetch(data_file_locations=True, dir_placement=str(into))]
    except Exception as error:  # whatever a network, an archive or a disk may raise
        said = " ".join(str(error).split()) or type(error).__name__
        raise DownloadError(f"the download into {into} failed: {said}") from None
    return files[0].parent
