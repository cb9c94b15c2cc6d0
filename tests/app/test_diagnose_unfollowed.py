"""A recording of which no model can be followed ends in one line with its name and what else may be asked."""

from pathlib import Path

import numpy as np
import pytest

from harness.app.diagnose import one
from harness.app.diagnose.many import diagnose
from harness.app.diagnose.options import DiagnoseOptions
from harness.core.errors import SimulationError


def test_the_file_and_what_may_be_asked_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def unfollowed(*_: object) -> None:
        raise SimulationError("the model could not be followed beyond t = 0.3 s: it diverged")

    monkeypatch.setattr(one, "conclude", unfollowed)
    t = np.arange(400.0) / 200.0
    file = tmp_path / "a.csv"
    file.write_text("t,x\n" + "".join(f"{s},{0.1 * np.exp(-0.5 * s) * np.cos(10.0 * s)}\n" for s in t))
    with pytest.raises(SimulationError) as caught:
        diagnose(file, DiagnoseOptions(), tmp_path / "out")
    assert str(caught.value) == (
        f"{file}: the model could not be followed beyond t = 0.3 s: it diverged; a part of it (--from, --to), or"
        " another --restoring or --zero, may be accepted"
    )
    assert not (tmp_path / "out").exists()
