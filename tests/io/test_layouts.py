"""Files as other programs write them are read right at the first try, without any option."""

from pathlib import Path

import numpy as np
import pytest
from layouts import WRITERS, drawn

from harness.io.recording import read_recording

DRAWS = 3
LOOSE = {"water_pendulum": 0.02, "capstone": 1e-4, "arduino_plotter": 1e-4, "odrive": 1e-4}
"""Of the largest value: what the digits of the file leave open."""


@pytest.mark.parametrize("draw", range(DRAWS))
@pytest.mark.parametrize("name", WRITERS)
def test_a_file_as_its_program_writes_it(tmp_path: Path, name: str, draw: int) -> None:
    rng = np.random.default_rng([draw, *name.encode()])
    path, wanted = WRITERS[name](tmp_path, drawn(rng), rng)
    found = read_recording(path)
    assert set(found.channels) == set(wanted) - {"t"}
    within = LOOSE.get(name, 2e-5)
    np.testing.assert_allclose(found.t - found.t[0], wanted["t"] - wanted["t"][0], atol=1e-3 if within > 1e-3 else 1e-5)
    for channel, values in found.channels.items():
        np.testing.assert_allclose(values, wanted[channel], atol=within * float(np.abs(wanted[channel]).max()))
