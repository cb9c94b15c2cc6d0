"""harness diagnose --together from end to end: one object, what each recording has of its own, one page, one trace."""

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest

import harness
from harness.app.diagnose.conditions import read_conditions
from harness.app.diagnose.many import diagnose_together
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.diagnose.together import repeated_results
from harness.app.report import rebuild
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.quantity import Quantity
from harness.kernels.solve import Drive, solve
from harness.model.model import Model
from harness.results import generate
from harness.results.diagnosis import DiagnosisResult


def is_rebuilt(result: DiagnosisResult, at: Path, says: str) -> None:
    """The page of a result, made again from its trace, is the page that was written, and says something."""
    _, page = rebuild(Path(result.files["rrd"]), at)
    text = page.read_text(encoding="utf-8")
    assert says in text
    assert text == Path(result.files["report"]).read_text(encoding="utf-8")


Done = tuple[DiagnosisResult, list[Path]]
STARTS, ZEROS = (0.1, 0.05), (0.01, -0.02)
DRIVEN_ZEROS, BEGINS = (0.0, 0.003), (0.0, 5.0)
WAVES = (((6.0, 3.1), (4.0, 7.3), (3.0, 14.0)), ((5.0, 2.3), (5.0, 6.1), (3.0, 11.0)))


def _saved(path: Path, header: str, *columns: FloatArray) -> Path:
    np.savetxt(path, np.column_stack(columns), "%.9g", ",", header=header, comments="")
    return path


def _released(folder: Path, i: int) -> Path:
    """The same slider from 100 mm and from 50 mm, the second with 5 % more inertia."""
    t = np.linspace(0.0, 4.0, 521)
    x = solve(Model((1.0, 1.05)[i], 0.25, 100.0, 0.35, x0=STARTS[i]), t).x + ZEROS[i]
    return _saved(folder / f"decay-{i}.csv", "t,x", t, x + 1e-4 * np.random.default_rng(i).standard_normal(t.size))


def _driven(folder: Path, i: int) -> Path:
    """The same slider under two forces, the second with 10 % more on it, its zero moved and its clock at 5 s."""
    draw, t = np.random.default_rng(i), np.arange(1504) / 250.0
    u = np.sum([a * np.sin(w * t + i) for a, w in WAVES[i]], axis=0)
    x = solve(Model((2.0, 2.2)[i], 3.0, 80.0, 1.5), t, drive=Drive(t, u)).x + DRIVEN_ZEROS[i]
    noisy = (x + 2e-6 * draw.standard_normal(t.size), u + 0.05 * draw.standard_normal(t.size))
    return _saved(folder / f"drive-{i}.csv", "t,x,u", t + BEGINS[i], *noisy)


def _heavier(result: DiagnosisResult, files: list[Path], by: float, errors: float, most: float) -> None:
    assert [Path(one.file).name for one in result.recordings] == [file.name for file in files]
    first, second = (one.differs for one in result.own)
    assert first == []
    (said,) = second
    what, value, _, error, *rest = said.split()
    assert what == "inertia"
    assert abs(float(value) - by) < errors * float(error) < most
    assert " ".join(rest) == f"% above that of {files[0].name}"
    assert result.of_first


@pytest.fixture(scope="module")
def released(tmp_path_factory: pytest.TempPathFactory) -> Done:
    folder = tmp_path_factory.mktemp("together")
    files = [_released(folder, i) for i in range(2)]
    return harness.diagnose(files, zero="free", engines=("mujoco",), out=folder / "out"), files


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Done:
    folder = tmp_path_factory.mktemp("driven")
    files = [_driven(folder, i) for i in range(2)]
    options = DiagnoseOptions(engines=("mujoco",))
    return diagnose_together([(file, str(file)) for file in files], options, folder / "out"), files


def test_each_decay_has_its_own_and_the_second_is_heavier(released: Done) -> None:
    result, files = released
    assert "explain these recordings, which differ in inertia, to their noise" in result.statement
    _heavier(result, files, 5.0, errors=4.0, most=0.4)
    for one, x0, zero in zip(result.own, STARTS, ZEROS, strict=True):
        assert one.start["x0"].value == pytest.approx(x0, abs=1e-3)
        assert one.zero is not None
        assert one.zero.value == pytest.approx(zero, abs=1e-4)
        assert one.noise["x"] == pytest.approx(1e-4, rel=0.15)
        assert one.rmse["x"] == pytest.approx(1e-4, rel=0.15)
    assert result.engines["mujoco"].refined_rmse["x"] == pytest.approx(1e-4, rel=0.3)


def test_each_drive_has_its_own_and_the_second_is_heavier(driven: Done) -> None:
    result, files = driven
    assert result.verdict == "adequate"
    _heavier(result, files, 10.0, errors=3.0, most=1.0)
    for one, zero in zip(result.own, DRIVEN_ZEROS, strict=True):
        assert one.start["x0"].value == pytest.approx(0.0, abs=1e-3)
        assert one.zero is not None
        assert one.zero.value == pytest.approx(zero, abs=3e-4)
        assert one.noise["x"] == pytest.approx(2e-6, rel=0.3)
        assert one.rmse["x"] < 1e-3
    assert result.own[0].begins_s == 0.0
    assert result.own[1].begins_s > 6.0
    # the engine has the mass of each in its own windows
    assert result.engines["mujoco"].refined_rmse["x"] == pytest.approx(result.refined.rmse["x"], rel=0.2)


def test_every_parameter_has_its_error_within_and_its_spread_between(released: Done) -> None:
    """5 % more inertia is 2.4 % less omega_n and zeta; x_k, friction over stiffness, is the same."""
    omega, x_k = released[0].together["omega_n"], released[0].together["x_k"]
    assert omega.between == pytest.approx(10.0 * (1.0 - 1.05**-0.5) / 2.0**0.5, rel=0.05)
    assert omega.within < 0.05 * omega.between < (omega.value.stderr or 0.0)
    assert x_k.between < 3.0 * x_k.within
    assert not omega.outliers
    assert not x_k.outliers


@pytest.mark.parametrize(("name", "begins"), [("released", (0.0, 0.0)), ("driven", BEGINS)])
def test_what_is_left_is_valid_and_the_trace_alone_gives_the_page(
    name: str, begins: tuple[float, float], request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    result, files = request.getfixturevalue(name)
    document = json.loads((files[0].parent / "out" / "result.json").read_text())
    jsonschema.validate(document, json.loads((generate.FOLDER / "harness.diagnosis-2.json").read_text()))
    rows = np.loadtxt(result.files["refined_trace"], delimiter=",", skiprows=1)
    assert Path(result.files["refined_trace"]).read_text().splitlines()[0] == "recording,t,x"
    for number, begin in enumerate(begins, 1):
        assert rows[rows[:, 0] == number][0, 1] == begin
    is_rebuilt(result, tmp_path / "page.html", "2 recordings of one machine")


def test_windows_belong_to_one_recording(driven: Done) -> None:
    files = [(path, str(path)) for path in driven[1]]
    with pytest.raises(InputError, match="--together: given with --"):
        diagnose_together(files, DiagnoseOptions(horizon=2.0))


def test_conditions_are_read_as_a_german_spreadsheet_writes_them(tmp_path: Path) -> None:
    (tmp_path / "tage.csv").write_text("\ufeffDatei;Temperatur [°C]\na.csv;20,5\nb.csv;\n", encoding="utf-8")
    assert read_conditions(tmp_path / "tage.csv") == {"a.csv": {"Temperatur [°C]": 20.5}, "b.csv": {}}


def test_a_series_is_told_as_a_trend_of_what_changes(tmp_path: Path) -> None:
    """Damping in proportion to the density of the air, dry friction not; a row without a number says nothing."""
    densities, random = [0.3, 0.6, 0.9, 1.2, 1.5], np.random.default_rng(2)
    rows = "".join(f"air-{i}.csv,{rho},{20 + 2 * i % 5}\n" for i, rho in enumerate(densities))
    (tmp_path / "days.csv").write_text(f"file,density [kg/m^3],temperature\n{rows}air-9.csv,,21\n")
    table = read_conditions(tmp_path / "days.csv")
    files = [f"runs/air-{i}.csv" for i in range(5)]
    each = [
        {
            "c": Quantity(0.05 * rho + 1e-3 * random.standard_normal(), 1e-3, "N s/m"),
            "f_k": Quantity(0.8 + 2e-3 * random.standard_normal(), 2e-3, "N"),
        }
        for rho in densities
    ]
    found = repeated_results(files, each, {"f_k": 0.01}, table)
    density, temperature = found["c"].trends
    assert density.differs
    assert density.slope.unit == "N s/m per kg/m^3"
    assert density.slope.value == pytest.approx(0.05, abs=4.0 * (density.slope.stderr or 0.0))
    assert not temperature.differs
    assert not any(trend.differs for trend in found["f_k"].trends)
    assert found["f_k"].expanded == pytest.approx(2.0 * np.hypot(found["f_k"].value.stderr or 0.0, 0.01))


def test_a_table_of_other_files_is_refused(released: Done) -> None:
    with pytest.raises(InputError, match=r"decay-0\.csv"):
        harness.diagnose(released[1], engines=(), conditions={"other.csv": {"density": 1.0}})
