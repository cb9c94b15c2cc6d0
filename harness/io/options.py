"""How somebody wants a recording to be read."""

from dataclasses import dataclass

from harness.core.checks import finite, positive
from harness.core.errors import InputError

UNSAID = float("1")
"""Hz: stands for a rate that nobody has said, while a choice of columns is tried."""


@dataclass(frozen=True, slots=True)
class ReadOptions:
    """How to read a recording.

    columns : the text of --columns. skip_rows : lines before the header. rate : Hz, where no column gives the time.
    start, stop : s, the part to keep (--from, --to). drop_nan : leave out rows in which a channel has no value.
    covariates : further columns, by name (--covariate).
    """

    columns: str | None = None
    skip_rows: int = 0
    rate: float | None = None
    start: float | None = None
    stop: float | None = None
    drop_nan: bool = False
    covariates: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.skip_rows < 0:
            raise InputError("--skip-rows", f"{self.skip_rows}", "0 or more is accepted")
        if self.rate is not None:
            positive("--rate", self.rate, "Hz")
        for name, value in (("--from", self.start), ("--to", self.stop)):
            if value is not None:
                finite(name, value)
        if self.start is not None and self.stop is not None and self.stop <= self.start:
            raise InputError("--to", f"{self.stop:g} s, not after --from {self.start:g} s", "a later time is accepted")

    @property
    def pasted(self) -> str:
        """The same as options of a command; HZ stands for a rate that is not known."""
        said = [
            "" if self.columns is None else f'--columns "{self.columns}"',
            f"--skip-rows {self.skip_rows}" if self.skip_rows else "",
            "" if self.rate is None else "--rate HZ" if self.rate is UNSAID else f"--rate {self.rate:.6g}",
            "" if self.start is None else f"--from {self.start:.9g}",
            "" if self.stop is None else f"--to {self.stop:.9g}",
            "--drop-nan" if self.drop_nan else "",
            *(f"--covariate '{name}'" for name in self.covariates),
        ]
        return " ".join(one for one in said if one)
