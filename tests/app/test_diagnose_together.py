"""harness diagnose --together from end to end: one object, what each recording has of its own, one page, one trace."""

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from rebuilt import is_rebuilt

import harness
from harness.kernels.solve import solve
from harness.model.model import Model
from harness.results import generate
from harness.results.diagnosis import DiagnosisResult

Done = tuple[DiagnosisResult, Path]
STARTS, ZEROS = (0.1, 0.05), (0.01, -0.02)


def written(folder: Path) -> list[tuple[Path, str]]:
    """The same slider from 100 mm and from 50 mm, the second with 5 % more inertia."""
    t = np.linspace(0.0, 4.0, 521)
    found = []
    for i, (x0, zero, m) in enumerate(zip(STARTS, ZEROS, (1.0, 1.05), strict=True)):
        x = solve(Model(m, 0.25, 100.0, 0.35, x0=x0), t).x
        x += zero + 1e-4 * np.random.default_rng(i).standard_normal(t.size)
        path = folder / f"decay-{i}.csv"
        np.savetxt(path, np.column_stack((t, x)), "%.9g", ",", header="t,x", comments="")
        found.append((path, str(path)))
    return found


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Done:
    folder = tmp_path_factory.mktemp("together")
    files = [path for path, _ in written(folder)]
    return harness.diagnose(files, zero="free", engines=("mujoco",), out=folder / "out"), folder


def test_each_has_its_own_and_the_second_is_heavier(done: Done) -> None:
    result, folder = done
    assert [Path(one.file).name for one in result.recordings] == ["decay-0.csv", "decay-1.csv"]
    for one, x0, zero in zip(result.own, STARTS, ZEROS, strict=True):
        assert one.start["x0"].value == pytest.approx(x0, abs=1e-3)
        assert one.zero is not None
        assert one.zero.value == pytest.approx(zero, abs=1e-4)
        assert one.noise["x"] == pytest.approx(1e-4, rel=0.15)
        assert one.rmse["x"] == pytest.approx(1e-4, rel=0.15)
    first, second = (one.differs for one in result.own)
    assert first == []
    assert len(second) == 1
    what, value, _, error, *rest = second[0].split()
    assert what == "inertia"
    assert abs(float(value) - 5.0) < 4.0 * float(error) < 0.4
    assert " ".join(rest) == f"% above that of {folder / 'decay-0.csv'}"
    assert result.engines["mujoco"].refined_rmse["x"] == pytest.approx(1e-4, rel=0.3)


def test_every_parameter_has_its_error_within_and_its_spread_between(done: Done) -> None:
    """5 % more inertia is 2.4 % less omega_n and zeta; x_k, friction over stiffness, is the same."""
    result, _ = done
    omega, x_k = result.together["omega_n"], result.together["x_k"]
    assert omega.between == pytest.approx(10.0 * (1.0 - 1.05**-0.5) / 2.0**0.5, rel=0.05)
    assert omega.within < 0.05 * omega.between < (omega.value.stderr or 0.0)
    assert x_k.between < 3.0 * x_k.within
    assert not omega.outliers
    assert not x_k.outliers


def test_what_is_left_is_whole_and_valid(done: Done) -> None:
    result, folder = done
    document = json.loads((folder / "out" / "result.json").read_text())
    jsonschema.validate(document, json.loads((generate.FOLDER / "harness.diagnosis-2.json").read_text()))
    rows = np.loadtxt(result.files["refined_trace"], delimiter=",", skiprows=1)
    header = Path(result.files["refined_trace"]).read_text().splitlines()[0]
    assert header == "recording,t,x"
    assert set(rows[:, 0]) == {1.0, 2.0}
    assert rows[rows[:, 0] == 2.0][0, 1] == 0.0


def test_the_trace_alone_gives_the_page(done: Done, tmp_path: Path) -> None:
    result, _ = done
    is_rebuilt(result, tmp_path / "page.html", "2 recordings of one machine")
