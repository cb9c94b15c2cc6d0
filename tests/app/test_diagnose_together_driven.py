"""harness diagnose --together of driven recordings from end to end: one object, what differs, one page, one trace."""

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from rebuilt import is_rebuilt

from harness.app.diagnose.many import diagnose_together
from harness.app.diagnose.options import DiagnoseOptions
from harness.core.errors import InputError
from harness.diagnosis.request import AskedCovariate
from harness.kernels.solve import Drive, solve
from harness.model.model import Model
from harness.results import generate
from harness.results.diagnosis import DiagnosisResult

Done = tuple[DiagnosisResult, Path]
ZEROS, BEGINS = (0.0, 0.003), (0.0, 5.0)
WAVES = (((6.0, 3.1), (4.0, 7.3), (3.0, 14.0)), ((5.0, 2.3), (5.0, 6.1), (3.0, 11.0)))


def written(folder: Path) -> list[tuple[Path, str]]:
    """The same slider under two forces, the second with 10 % more on it, its zero moved and its clock at 5 s."""
    found = []
    for i, (zero, begin, m) in enumerate(zip(ZEROS, BEGINS, (2.0, 2.2), strict=True)):
        draw, t = np.random.default_rng(i), np.arange(1504) / 250.0
        u = np.sum([a * np.sin(w * t + i) for a, w in WAVES[i]], axis=0)
        x = solve(Model(m, 3.0, 80.0, 1.5), t, drive=Drive(t, u)).x + zero + 2e-6 * draw.standard_normal(t.size)
        path = folder / f"drive-{i}.csv"
        table = np.column_stack((t + begin, x, u + 0.05 * draw.standard_normal(t.size)))
        np.savetxt(path, table, "%.9g", ",", header="t,x,u", comments="")
        found.append((path, str(path)))
    return found


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Done:
    folder = tmp_path_factory.mktemp("together")
    return diagnose_together(written(folder), DiagnoseOptions(engines=("mujoco",)), folder / "out"), folder


def test_each_has_its_own_and_the_second_is_heavier(done: Done) -> None:
    result, folder = done
    assert result.verdict == "adequate"
    assert [Path(one.file).name for one in result.recordings] == ["drive-0.csv", "drive-1.csv"]
    for one, zero in zip(result.own, ZEROS, strict=True):
        assert one.start["x0"].value == pytest.approx(0.0, abs=1e-3)
        assert one.zero is not None
        assert one.zero.value == pytest.approx(zero, abs=3e-4)
        assert one.noise["x"] == pytest.approx(2e-6, rel=0.3)
        assert one.rmse["x"] < 1e-3
    first, second = result.own
    assert (first.begins_s, first.differs) == (0.0, [])
    assert second.begins_s > 6.0
    (said,) = second.differs
    what, value, _, error, *rest = said.split()
    assert what == "inertia"
    assert abs(float(value) - 10.0) < 3.0 * float(error) < 1.0
    assert " ".join(rest) == f"% above that of {folder / 'drive-0.csv'}"
    # the engine has the mass of each in its own windows
    assert result.engines["mujoco"].refined_rmse["x"] == pytest.approx(result.refined.rmse["x"], rel=0.2)


def test_what_is_left_is_whole_and_valid(done: Done) -> None:
    result, folder = done
    document = json.loads((folder / "out" / "result.json").read_text())
    jsonschema.validate(document, json.loads((generate.FOLDER / "harness.diagnosis-2.json").read_text()))
    rows = np.loadtxt(result.files["refined_trace"], delimiter=",", skiprows=1)
    assert Path(result.files["refined_trace"]).read_text().splitlines()[0] == "recording,t,x"
    for number, begin in enumerate(BEGINS, 1):
        assert rows[rows[:, 0] == number][0, 1] == begin


def test_the_trace_alone_gives_the_page(done: Done, tmp_path: Path) -> None:
    result, _ = done
    is_rebuilt(result, tmp_path / "page.html", "2 recordings of one machine")


def test_what_acts_beside_the_force_belongs_to_one_recording(done: Done) -> None:
    files = [(path, str(path)) for path in sorted(done[1].glob("drive-*.csv"))]
    for options in (DiagnoseOptions(covariates=(AskedCovariate("P"),)), DiagnoseOptions(horizon=2.0)):
        with pytest.raises(InputError, match="--together: given with --"):
            diagnose_together(files, options)
