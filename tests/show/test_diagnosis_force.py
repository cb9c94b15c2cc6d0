"""Forces without a name on the page: curves with their band, and a plane that is blank where the motion never was."""

import json
from typing import Any

import numpy as np
from diagnose_examples import example

from harness.results.diagnosis import SurfaceResult, TableResult
from harness.show.blocks import Figure
from harness.show.report.diagnosis_figures import nameless
from harness.show.report.page import Pool

SIDE = [-1.0, 0.0, 1.0]
CURVE: dict[str, Any] = {
    "form": "f(x)",
    "of": "x",
    "at": SIDE,
    "at_unit": "m",
    "force": [0.1, 0.2, 0.3],
    "stderr": [0.01, 0.01, 0.01],
    "force_unit": "N",
    "gauge": "no straight line",
    "described": "odd",
    "nearest": [{"name": "cubic-stiffness", "share": 0.8}],
}
PLANE: dict[str, Any] = {
    "form": "f(x, v)",
    "x": SIDE,
    "x_unit": "m",
    "v": SIDE,
    "v_unit": "m/s",
    "force": [[None, -0.5, None], [0.0, 0.1, 0.0], [None, 0.4, None]],
    "stderr": [[None, 0.1, None], [0.2, 0.1, 0.2], [None, 0.1, None]],
    "force_unit": "N",
    "gauge": "no force of position alone",
    "described": "a resistance that depends on the place too",
}


def figures(curves: int, plane: bool) -> list[Figure]:
    tables = [TableResult.model_validate(CURVE)] * curves
    surface = SurfaceResult.model_validate(PLANE) if plane else None
    found = nameless(example("bench.csv", tables=tables, surface=surface)).blocks
    return [block for block in found if isinstance(block, Figure)]


def test_a_curve_is_drawn_with_its_band_and_what_comes_near() -> None:
    (figure,) = figures(1, False)
    assert len(figure.traces) == 3
    assert np.allclose(figure.traces[1]["y"] - figure.traces[0]["y"], 0.04)
    assert "cubic-stiffness (80 % of it)" in figure.caption


def test_a_plane_is_blank_where_nothing_is_known() -> None:
    curve, plane = figures(1, True)
    assert curve.name != plane.name
    assert plane.traces[0]["z"][0] == [None, -0.5, None]
    assert (plane.traces[0]["zmin"], plane.traces[0]["zmax"]) == (-0.5, 0.5)
    assert "A resistance that depends on the place too" in plane.caption
    assert "there nothing is known" in plane.caption
    # as the page writes it: no number that JSON does not have
    json.dumps(Pool().spec(plane), allow_nan=False)


def test_a_plane_stands_alone() -> None:
    (plane,) = figures(0, True)
    assert plane.layout["yaxis"]["title"]["text"] == "speed / (m/s)"
