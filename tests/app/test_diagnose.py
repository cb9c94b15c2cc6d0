"""A diagnosis from end to end, and several in one call: what is found, said and left; order, failures, resumption."""

import json
import math
import os
import re
import shlex
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from diagnose_examples import STOP, example, stopped

import harness
from harness.app.diagnose import one
from harness.app.diagnose.many import Answer, Work, compute, diagnose, diagnose_all, failed, folder_names
from harness.app.diagnose.one import FILES, deliver
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.diagnose.problem import prepared
from harness.app.report import rebuild
from harness.app.shared.reading import ReadOptions, read, read_as, spooled
from harness.core.errors import InputError, SimulationError, StoreError
from harness.core.recording import Recording
from harness.core.slider import Slider
from harness.exact.decay import Decay, free_decay
from harness.io.recording import sha256
from harness.io.store import output_folder
from harness.kernels.solve import solve
from harness.model.document import load
from harness.model.model import Model, ModelTerm, Restoring
from harness.results import generate
from harness.results.diagnosis import DiagnosisDocument, DiagnosisResult, FailedDiagnosis

Done = tuple[DiagnosisResult, Path, Path]


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Done:
    """Result, recording and output folder of a decay against a stop."""
    folder = tmp_path_factory.mktemp("diagnose")
    path = stopped(folder / "decay.csv")
    return diagnose(path, DiagnoseOptions(), folder / "out", command="harness diagnose"), path, folder / "out"


def test_a_beginning_that_no_law_explains_is_said_to_be_skipped_before_all_else() -> None:
    """Drag all the way, and a stop beyond 60 mm that only the release from 80 mm touches: 5 half-swings are left."""
    terms = (ModelTerm.named("quadratic-drag", c2=1.5), ModelTerm.named("end-stop:positive", gap=0.06, k_stop=400.0))
    t = np.arange(0.0, 9.0, 4e-3)
    motion = solve(Model(1.0, 0.25, 60.0, 0.35, x0=0.08, terms=terms), t)
    rng = np.random.default_rng(0)
    channels = {"x": motion.x + rng.normal(0.0, 2e-5, t.size), "a": motion.a + rng.normal(0.0, 5e-3, t.size)}
    found = harness.diagnose(Recording(t, channels, "two.csv"), engines=())
    names = [one.name for one in found.mechanisms]
    assert "quadratic-drag" in names
    skipped = r"the first 0[.]\d+ s, up to the first turning point, are skipped"
    assert "end-stop" in names or re.match(skipped, found.warnings[0])


def test_the_stop_is_found_with_its_place_and_stiffness(done: Done) -> None:
    result = done[0]
    assert result.verdict == "missing_physics"
    (found,) = result.mechanisms
    assert (found.name, found.family, found.variant) == ("end-stop", "stiffness", "positive")
    for name, true in (("gap", 0.05), ("k_stop", 60.0)):
        p = found.parameters[name]
        assert p.value is not None
        assert p.stderr is not None
        assert abs(p.value - true) < 4.0 * p.stderr
    assert result.refined.chi2_per_point == pytest.approx(1.0, abs=0.15)
    assert result.baseline.chi2_per_point is not None
    assert result.baseline.chi2_per_point > 50.0
    assert found.where.regime == "one-side"
    assert found.where.share is not None
    assert 0.0 < found.where.share < 1.0
    assert found.name in result.statement.replace(" ", "-")


def test_the_law_is_seen_in_the_recording_where_the_base_model_has_none(done: Done) -> None:
    (law,) = done[0].laws
    assert (law.names, law.over, law.level) == (["end-stop"], "x", False)
    at, seen, error = (np.array(values) for values in (law.at, law.seen, law.stderr))
    true = 60.0 * np.maximum(at - 0.05, 0.0)
    assert float(np.max(true)) > 1.0
    # the base model's own spring stands for what it can
    assert float(np.mean(((seen - true) / error) ** 2)) < 3.0
    assert float(np.mean(((np.array(law.base) - true) / error) ** 2)) > 10.0
    assert np.array(law.fitted) == pytest.approx(true, abs=0.05 * float(np.max(true)))


@pytest.mark.usefixtures("pybullet")
def test_the_fit_improves_where_it_was_not_fitted_and_in_both_engines(done: Done) -> None:
    result = done[0]
    assert set(result.engines) == {"mujoco", "pybullet"}
    for channel in ("x", "a"):
        assert result.holdout.refined_rmse[channel] < 0.5 * result.holdout.baseline_rmse[channel]
        for engine in result.engines.values():
            assert engine.error is None
            assert engine.refined_rmse[channel] < 0.5 * engine.baseline_rmse[channel]


def test_shares_of_the_mismatch_add_up_to_all_of_it(done: Done) -> None:
    found = done[0].attribution
    assert found is not None
    assert found.engine is not None
    shares = (found.engine, found.parameters, found.missing_physics, found.unexplained, found.noise)
    assert sum(shares) == pytest.approx(1.0, abs=1e-12)
    assert sum(bar.share for bar in found.bars) == pytest.approx(1.0, abs=1e-12)
    assert min(bar.share for bar in found.bars) >= 0.0
    # without --model the configuration is the baseline fit, whose parameters stand for a part of what it lacks
    assert found.parameters + found.missing_physics > 0.9
    assert found.missing_physics > 0.4


def test_what_is_left_is_whole_and_valid(done: Done) -> None:
    result, _, folder = done
    assert all(Path(file).is_file() and Path(file).is_absolute() for file in result.files.values())
    assert {"report", "rrd", "mjcf", "urdf", "model", "residual_map", "refined_trace"} <= set(result.files)
    data = json.loads((folder / "result.json").read_text())
    assert data == json.loads(result.model_dump_json(by_alias=True))
    jsonschema.validate(data, json.loads((generate.FOLDER / "harness.diagnosis-2.json").read_text()))
    DiagnosisDocument.model_validate([data])
    assert not list(folder.parent.glob(".*"))


def test_the_refined_trace_has_the_times_of_the_file_and_the_motion_behind_it(done: Done) -> None:
    result, path, _ = done
    recorded = np.loadtxt(path, delimiter=",", skiprows=1)
    refined = np.loadtxt(result.files["refined_trace"], delimiter=",", skiprows=1)
    np.testing.assert_array_equal(refined[:, 0], recorded[:, 0])
    for i, sigma in ((1, 1e-4), (2, 0.05)):
        # the median, since a sample beside a reversal may lie on the other side of the jump
        level = float(np.median(np.abs(refined[:, i] - recorded[:, i]))) / 0.6745
        assert level == pytest.approx(sigma, rel=0.15)


def test_the_refined_trace_says_nothing_of_the_time_before_the_release(tmp_path: Path) -> None:
    """A hold of .4 s: no row stands for it."""
    t = np.arange(0.0, 4.4, 5e-3)
    x = solve(Model(1.0, 0.4, 100.0, 0.3, x0=0.2, t0=0.4), t).x
    x = x + 1e-4 * np.random.default_rng(4).standard_normal(t.size)
    options = DiagnoseOptions(engines=(), zero="spring")
    result = deliver(Recording(t, {"x": x}, "held.csv"), options, tmp_path / "out")
    refined = np.loadtxt(result.files["refined_trace"], delimiter=",", skiprows=1)
    release = float(result.refined_model.release.t0)
    assert 0.39 < release < 0.5
    np.testing.assert_array_equal(refined[:, 0], t[t >= release])
    assert np.all(np.abs(np.diff(refined[:20, 1])) > 0.0)


def test_the_model_left_is_the_one_that_was_found(done: Done) -> None:
    result = done[0]
    model = load(Path(result.files["model"]))
    assert [entry.term.key for entry in model.terms] == ["end-stop:positive"]
    assert model.terms[0].value("gap") == pytest.approx(0.05, rel=0.01)
    assert result.refined_model.terms[0].parameters["gap"] == model.terms[0].value("gap")
    assert any("release" in sentence for sentence in result.model_left_out)


def test_the_trace_alone_gives_the_page(done: Done, tmp_path: Path) -> None:
    result, _, folder = done
    alone = tmp_path / "alone.rrd"
    alone.write_bytes((folder / "trace.rrd").read_bytes())
    again, page = rebuild(alone)
    assert again == result
    assert page.read_bytes() == (folder / "report.html").read_bytes()


def test_a_recording_of_nothing_but_friction_is_adequate_in_one_engine(tmp_path: Path) -> None:
    path = stopped(tmp_path / "plain.csv", replace(STOP, terms=()), 300, 0.012)
    options = DiagnoseOptions.chosen(ReadOptions(), engines=("mujoco",))
    result = diagnose(path, options, tmp_path / "out")
    assert (result.verdict, result.mechanisms, list(result.engines)) == ("adequate", [], ["mujoco"])
    assert result.baseline == result.refined
    assert result.settings["engines"] == ["mujoco"]


def test_standard_input_is_read_as_a_file_and_called_by_its_own_name(tmp_path: Path) -> None:
    path = stopped(tmp_path / "decay.csv")
    with path.open("rb") as stream, spooled(stream) as file:
        found = read_as("-", file, ReadOptions())
        assert found.file == "-"
        assert found.sha256 == read(path, ReadOptions()).sha256
        with pytest.raises(InputError, match=r"^-: the columns t, x, a. Try: "):
            read_as("-", file, ReadOptions("t=t,u=x"))
    assert not file.exists()


T = np.arange(0.0, 4.0, 0.004)
X = np.exp(-0.3 * T) * np.cos(10.0 * T) + 1e-4 * np.random.default_rng(0).normal(size=T.size)
A = -100.0 * np.exp(-0.3 * T) * np.cos(10.0 * T) + 0.1 * np.random.default_rng(1).normal(size=T.size)


def asked(channels: dict[str, np.ndarray], units: dict[str, str] | None = None, **options: Any) -> tuple[str, ...]:
    chosen = DiagnoseOptions.chosen(ReadOptions(), **options)
    return prepared(Recording(T, channels, "bench.csv", units=units or {}), chosen).warnings


def test_a_unit_off_by_a_thousand_is_refused_with_the_one_that_it_is_in() -> None:
    assert asked({"x": X, "a": A}) == ()
    with pytest.raises(InputError) as refused:
        asked({"x": 1e3 * X, "a": A})
    assert "x=x[mm]" in str(refused.value)


@pytest.mark.parametrize(
    ("far", "slow", "angular", "question"),
    [
        (1.0, 1.0, False, ""),
        (1.0, 1.0, True, ""),
        (1e3, 1.0, False, "is x in mm?"),
        (1.0, 1e3, False, "is t in ms?"),
        (math.degrees(1.0), 1.0, True, "is it in deg?"),
    ],
)
def test_a_swing_of_another_unit_is_asked_about(far: float, slow: float, angular: bool, question: str) -> None:
    """A slider from 1 m or rad at 10 rad/s, its numbers those of another unit than the one that is said."""
    recording = Recording(slow * T, {"x": far * X}, "bench.csv", angular=angular, columns={"t": "t[s]", "x": "x[m]"})
    said = prepared(recording, DiagnoseOptions(restoring=Restoring.SPRING)).warnings
    assert [question in line for line in said] == ([True] if question else [])
    for line in said:
        unit = question.removesuffix("?").split()[-1]
        assert f"[{unit}]" in line.split("--columns")[1]


NAMES = ("a.csv", "b.csv", "bad.csv", "c.csv", "d.csv")


def stand_in(work: Work) -> Answer:
    """A worker that reads the file instead of diagnosing it, dies of one, is long at one, and fails with another."""
    text = work.path.read_text()
    if "die" in text:
        os._exit(3)
    if "full" in text:
        raise StoreError("a.csv: no space left on the device")
    if "writes" in text:
        with output_folder("one", work.folder) as output:
            (output / "result.json").write_text("{")
            (work.path.parent / "writing").touch()
            time.sleep(600)
    if "fills" in text:
        while not (work.path.parent / "writing").exists():
            time.sleep(0.05)
        raise StoreError("b.csv: no space left on the device")
    if "long" in text:
        time.sleep(600)
    if "bad" in text:
        return failed(work.label, "bad.csv: 0 rows; expected at least 50")
    work.folder.mkdir(exist_ok=True)
    report = work.folder / FILES["report"]
    report.write_text("")
    result = example(
        work.label, sha256(work.path), settings=work.options.settings(), files={"report": str(report)}, warnings=[text]
    )
    (work.folder / FILES["result"]).write_text(result.model_dump_json(by_alias=True))
    return result


def write(folder: Path, **content: str) -> list[tuple[Path, str]]:
    for name in NAMES:
        (folder / name).write_text(content.get(name.split(".")[0], name))
    return [(folder / name, str(folder / name)) for name in NAMES]


def test_answers_keep_the_order_and_a_bad_file_does_not_stop_the_rest(tmp_path: Path) -> None:
    many = diagnose_all(write(tmp_path), DiagnoseOptions(), tmp_path / "out", 1, function=stand_in)
    assert [Path(answer.recording.file).name for answer in many.answers] == list(NAMES)
    assert [type(answer) for answer in many.answers].count(FailedDiagnosis) == many.failed == 1
    data = json.loads((tmp_path / "out" / "result.json").read_text())
    jsonschema.validate(data, json.loads((generate.FOLDER / "harness.diagnosis-2.json").read_text()))
    assert data[2] == {
        "schema": "harness.diagnosis/2",
        "recording": {"file": str(tmp_path / "bad.csv")},
        "verdict": "error",
        "error": "bad.csv: 0 rows; expected at least 50",
        "mechanisms": [],
    }
    page = (tmp_path / "out" / "index.html").read_text()
    assert '<a href="a/report.html">a.csv</a>' in page
    assert "could not be diagnosed" in page


@pytest.mark.parametrize(
    ("other", "k", "said", "line"),
    [
        (0.3, 60.0, "the same omega_n, zeta and x_k", "harness diagnose {0} {1} --columns x=x --together"),
        (0.6, 60.0, "differ: x_k 0.00500", "harness diagnose --columns x=x --before {0} --after {1}"),
        (0.3, 120.0, "", ""),
    ],
    ids=["alike", "twice the friction", "another machine"],
)
def test_two_decays_of_what_may_be_one_machine_are_led_on(
    tmp_path: Path, other: float, k: float, said: str, line: str
) -> None:
    t, named = np.arange(0.0, 5.0, 0.01), list[tuple[Path, str]]()
    for i, (friction, stiffness) in enumerate([(0.3, 60.0), (other, k)]):
        x = free_decay(Decay.of(Slider(1.0, 0.2, stiffness, friction), 0.1), t).x
        x = x + 1e-4 * np.random.default_rng(i).standard_normal(t.size)
        path = tmp_path / f"run-{i}.csv"
        np.savetxt(path, np.column_stack((t, x)), delimiter=",", header="t,x", comments="")
        named.append((path, str(path)))
    files = [label for _, label in named]
    command = shlex.join(["harness", "diagnose", *files, "--out", "there", "--columns", "x=x", "--json=a"])
    many = diagnose_all(named, DiagnoseOptions(engines=()), tmp_path / "out", 1, command=command)
    assert said in many.advice
    assert many.advice.endswith(line.format(*map(shlex.quote, files)))
    assert bool(many.advice) is bool(said)
    # with itself it would count twice
    again = diagnose_all([named[0], named[0]], DiagnoseOptions(engines=()), tmp_path / "twice", 1, command=command)
    assert again.advice == ""


def test_a_full_disk_leaves_nothing_of_what_others_were_writing(tmp_path: Path) -> None:
    named = write(tmp_path, a="writes", b="fills")[:2]
    with pytest.raises(StoreError, match="no space left"):
        diagnose_all(named, DiagnoseOptions(), tmp_path / "out", 2, function=stand_in)
    assert list((tmp_path / "out").iterdir()) == []


def test_a_process_that_dies_costs_one_file(tmp_path: Path) -> None:
    # two: one dies, and the other, whose pool breaks with it, is tried again; every new process costs an import of all
    named = write(tmp_path, b="die")[:2]
    many = diagnose_all(named, DiagnoseOptions(), tmp_path / "out", 2, function=stand_in)
    errors = {Path(a.recording.file).name: a.error for a in many.answers if isinstance(a, FailedDiagnosis)}
    assert [Path(a.recording.file).name for a in many.answers] == ["a.csv", "b.csv"]
    assert set(errors) == {"b.csv"}
    assert errors["b.csv"] == "the process that worked on it ended early (BrokenProcessPool)"


def test_resumption_computes_what_is_not_there_and_refuses_what_is_of_other_options(tmp_path: Path) -> None:
    named = write(tmp_path)
    diagnose_all(named[:3], DiagnoseOptions(), tmp_path / "out", 1, function=stand_in)
    computed: list[str] = []

    def counting(work: Work) -> Answer:
        computed.append(work.path.name)
        return stand_in(work)

    many = diagnose_all(named, DiagnoseOptions(), tmp_path / "out", 1, True, function=counting)
    # what failed is tried again
    assert computed == ["bad.csv", "c.csv", "d.csv"]
    assert len(many.answers) == len(NAMES)
    other = DiagnoseOptions.chosen(ReadOptions(rate=100.0), mass=2.0)
    with pytest.raises(InputError, match="--resume: a was made with another rate_hz, mass_kg; "):
        diagnose_all(named, other, tmp_path / "out", 1, True, function=counting)
    named[0][0].write_text("changed")
    with pytest.raises(InputError, match=r"--resume: a was made of another file than .*a\.csv; "):
        diagnose_all(named, DiagnoseOptions(), tmp_path / "out", 1, True, function=counting)
    with pytest.raises(InputError, match="--resume: given without --out; "):
        diagnose_all(named, DiagnoseOptions(), None, 1, True)


@pytest.mark.parametrize("jobs", [2])
def test_a_full_disk_ends_the_call_and_not_one_file_after_the_other(jobs: int, tmp_path: Path) -> None:
    # what is in work beside it is not waited for
    named = write(tmp_path, c="full", d="long")
    with pytest.raises(
        StoreError, match=r"no space left on the device; [23] of 5 recordings are kept. Try: --resume --out"
    ):
        diagnose_all(named, DiagnoseOptions(), tmp_path / "out", jobs, function=stand_in)
    named = write(tmp_path)
    assert len(diagnose_all(named, DiagnoseOptions(), tmp_path / "out", 1, True, function=stand_in).answers) == len(
        NAMES
    )


def test_files_of_one_name_get_folders_of_their_own() -> None:
    assert folder_names(["x/a.csv", "y/a.csv.gz", "-", "b.csv"]) == ["a", "a-2", "stdin", "b"]


def test_a_file_that_cannot_be_read_is_an_entry(tmp_path: Path) -> None:
    (tmp_path / "two.csv").write_text("t,x\n0,1\n1,2\n")
    answer = compute(Work(tmp_path / "two.csv", "two.csv", tmp_path / "out"))
    assert not isinstance(answer, DiagnosisResult)
    assert answer.error == "two.csv: 2 samples; expected at least 50"
    assert not (tmp_path / "out").exists()


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
        f"{file}: the model could not be followed beyond t = 0.3 s: it diverged; expected a part of it"
        " that can (--from, --to), or another --restoring or --zero"
    )
    assert not (tmp_path / "out").exists()
