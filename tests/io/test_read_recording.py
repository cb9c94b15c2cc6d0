"""Every accepted format gives the same recording; everything else is refused by name."""

import gzip
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import scipy.io

from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.io.options import ReadOptions
from harness.io.recording import read_recording, sha256
from harness.io.times import Clock

N = 400
T = np.arange(N) / 200.0
X = np.exp(-0.5 * T) * np.cos(10.0 * T)
A = -100.0 * X
COLUMNS = {"t [ms]": T * 1e3, "x [mm]": X * 1e3, "a [g]": A / 9.80665, "F [lbf]": A / 4.4482216152605}


def rows(separator: str = ",", decimal: str = ".") -> str:
    table = np.stack(list(COLUMNS.values()), axis=1)
    lines = [separator.join(repr(float(v)).replace(".", decimal) for v in row) for row in table]
    return separator.join(COLUMNS) + "\n" + "\n".join(lines) + "\n"


def _saved_by_numpy(path: Path) -> None:
    np.savetxt(path, np.stack(list(COLUMNS.values()), axis=1), header=" ".join(COLUMNS), fmt="%.17g")


def _of(data: bytes) -> Callable[[Path], object]:
    return lambda path: path.write_bytes(data)


def structs() -> pa.Table:
    """Time beside a struct of a struct and of plain columns."""
    t, x, a, u = (pa.array(values) for values in COLUMNS.values())
    names = list(COLUMNS)
    inner = pa.StructArray.from_arrays([x], [names[1]])
    return pa.table({names[0]: t, "rig": pa.StructArray.from_arrays([inner, a, u], ["encoder", *names[2:]])})


FORMATS: dict[str, tuple[str, Callable[[Path], object]]] = {
    "csv": ("a.csv", _of(rows().encode())),
    "windows": ("a.csv", _of(b"\xef\xbb\xbf" + rows().replace("\n", "\r\n").encode())),
    "old mac": ("a.csv", _of(rows().replace("\n", "\r").encode())),
    "german": ("a.csv", _of(rows(";", ",").encode())),
    "packed": ("a.csv.gz", _of(gzip.compress(rows().encode()))),
    "blanks": ("a.txt", _of("\n".join("   " + line for line in rows("   ").splitlines()).encode())),
    "saved by numpy": ("a.dat", _saved_by_numpy),
    "tabs": ("a.tsv", _of(rows("\t").encode())),
    "parquet": ("a.parquet", lambda path: pq.write_table(pa.table(COLUMNS), path)),
    "npz": ("a.npz", lambda path: np.savez(path, **COLUMNS)),  # type: ignore[arg-type]
}


def check(recording: Recording) -> None:
    np.testing.assert_allclose(recording.t, T, rtol=1e-14, atol=1e-16)
    for name, wanted in (("x", X), ("a", A), ("u", A)):
        np.testing.assert_allclose(recording[name], wanted, rtol=1e-14, atol=1e-15)
    assert not recording.angular


@pytest.mark.parametrize("kind", FORMATS)
def test_every_format_gives_the_same_recording_in_si(tmp_path: Path, kind: str) -> None:
    name, write = FORMATS[kind]
    path = tmp_path / name
    write(path)
    recording = read_recording(path)
    check(recording)
    assert dict(recording.units) == {"t": "ms", "x": "mm", "a": "g", "u": "lbf"}
    assert recording.sha256 == sha256(path)
    assert recording.notes == ()


def test_fields_of_structs_of_parquet_are_columns(tmp_path: Path) -> None:
    """By themselves, and by the dotted names that the note says; a struct that is missing is no value."""
    path = tmp_path / "a.parquet"
    pq.write_table(structs(), path)
    found = read_recording(path)
    check(found)
    assert any("x from rig.encoder.x [mm]" in note for note in found.notes)
    given = "t='t [ms]'[ms],x='rig.encoder.x [mm]'[mm],a='rig.a [g]'[g],u='rig.F [lbf]'[lbf]"
    check(read_recording(path, ReadOptions(columns=given)))
    holed = [None if i == 7 else {"x": v} for i, v in enumerate(X.tolist())]
    pq.write_table(pa.table({"t": T, "rig": holed}), path)
    assert "1 rows without a value, the first of them row 8, are skipped." in read_recording(path).notes


def test_maps_of_parquet_are_columns_by_the_keys_of_the_first(tmp_path: Path) -> None:
    """In any order of keys; a key that a row lacks is no value."""
    path = tmp_path / "a.parquet"
    rig = [
        [("x [mm]", v), ("a [g]", a)][:: -1 if i % 3 else 1] for i, (v, a) in enumerate(zip(X * 1e3, A, strict=True))
    ]
    rig[7] = rig[7][:1]
    kind = pa.map_(pa.string(), pa.float64())
    pq.write_table(pa.table({"t": T, "rig": pa.array(rig, kind)}), path)
    found = read_recording(path)
    assert "1 rows without a value, the first of them row 8, are skipped." in found.notes
    np.testing.assert_allclose(found["x"], np.delete(X, 7), rtol=1e-14)
    np.testing.assert_allclose(found["a"], np.delete(A, 7) * 9.80665, rtol=1e-14)


MAT_COLUMNS = "t=t[ms],x=x[mm],a=a[g],u=v*gain*2[N]"


def test_matlab_5_with_a_constant_and_a_struct(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    named = {"t": T * 1e3, "x": X * 1e3, "a": A / 9.80665, "v": A / 6.0, "gain": 3.0, "note": "text"}
    scipy.io.savemat(path, named)
    check(read_recording(path, ReadOptions(columns=MAT_COLUMNS)))
    scipy.io.savemat(path, {"run": named})
    dotted = "t=run.t[ms],x=run.x[mm],a=run.a[g],u=run.v*run.gain*2[N]"
    check(read_recording(path, ReadOptions(columns=dotted)))


def test_matlab_7_3(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in (
            ("t", T * 1e3),
            ("x", X * 1e3),
            ("a", A / 9.80665),
            ("v", A / 6.0),
            ("gain", np.array([3.0])),
        ):
            file[name] = values[None, :]
            file[name].attrs["MATLAB_class"] = np.bytes_("double")
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(128))
    check(read_recording(path, ReadOptions(columns=MAT_COLUMNS)))


def test_matrix_columns_by_position(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    np.savez(path, np.stack([T, X], axis=1))
    recording = read_recording(path, ReadOptions(columns="t=#1,x=#2"))
    np.testing.assert_array_equal(recording["x"], X)


def test_degrees_by_position_with_rate_and_cut(tmp_path: Path) -> None:
    path = tmp_path / "swing.txt"
    path.write_text("start_deg, rate, duration\n45, 200, 2 \n" + "\n".join(f"{v:.17g}" for v in np.degrees(X)) + "\n")
    options = ReadOptions(columns="x=#1[deg]", skip_rows=2, rate=200.0, start=0.4, stop=1.5)
    recording = read_recording(path, options)
    assert recording.angular
    assert recording.t[0] == 0.4
    assert recording.t[-1] == 1.5
    np.testing.assert_allclose(recording["x"], X[80:301], rtol=1e-14)


def test_text_in_a_column_nobody_asks_for_does_no_harm(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("t,remark,x\n" + "".join(f"{t},ok,{x}\n" for t, x in zip(T, X, strict=True)))
    np.testing.assert_array_equal(read_recording(path)["x"], X)


def test_irregular_sampling_and_gaps_are_reported(tmp_path: Path) -> None:
    t = T + 0.001 * np.sin(np.arange(N))
    t[200:] += 0.5
    path = tmp_path / "a.npz"
    np.savez(path, t=t, x=X)
    notes = read_recording(path).notes
    assert len(notes) == 2
    assert "irregular" in notes[0]
    assert "1 gap" in notes[1]
    assert "0.505 s" in notes[1]


def edited(change: Callable[[list[str]], None], header: str = "t,x") -> str:
    lines = [header, *(f"{t:.6f},{x:.6f}" for t, x in zip(T, X, strict=True))]
    change(lines)
    return "\n".join(lines) + "\n"


def put(line: int, text: str) -> str:
    return edited(lambda lines: lines.__setitem__(line, text))


def headed(header: str) -> str:
    return edited(lambda lines: None, header)


def backwards(lines: list[str]) -> None:
    lines[102:] = reversed(lines[2:102])


def without_values(lines: list[str]) -> None:
    lines[12:50] = [f"{line.partition(',')[0]},nan" for line in lines[12:50]]


def ragged(lines: list[str]) -> None:
    lines[7:9] = ["0.03,1,2"] * 2


def blank_line(lines: list[str]) -> None:
    lines.insert(3, "")
    lines[9] = "0.035,oops"


PLAIN = headed("t,x")
ANOTHER = "is a unit of another kind"
VOLTS = (
    """column x: 'V' is a unit of another kind (a voltage), whose scale goes in place of 1. Try: --columns "t=t,x=1*"""
)
ANGLES = "angle, rate, duration\n90, 1000, 5\n" + "".join(f"{90.0 - i * i}\n" for i in range(60))
REFUSED: dict[str, tuple[Any, ...]] = {
    "time and rate": (PLAIN, "--rate: given although a column", ReadOptions(rate=100.0)),
    "time goes back": (edited(backwards), "row 102 (line 103), column t: time 0.5 s does not come after 0.5 s"),
    "49 samples": (edited(lambda lines: lines.__delitem__(slice(50, None))), "49 samples; expected at least 50"),
    "no samples": ("t,x\n", "0 rows under the header"),
    "empty file": ("", "no rows"),
    "nan": (edited(without_values), "row 12 (line 13), column x: no value or nan. Try: --drop-nan"),
    "infinite": (put(12, "0.055,-inf"), "row 12 (line 13), column x: -inf. Try: --drop-nan, which reads"),
    "infinite time": (put(12, "inf,1"), "row 12 (line 13), column t: inf"),
    "text": (put(7, "0.03,high"), "row 7 (line 8), column x: the text 'high'; expected a number"),
    "text after a blank line": (edited(blank_line), "row 8 (line 10), column x: the text 'oops'"),
    "ragged": (edited(ragged), "row 7 (line 9): 3 cells; expected 2, as in the first row"),
    "constant": (
        "t,x\n" + "".join(f"{t},1.5\n" for t in T),
        "column x: the constant 1.5; expected a channel that moves",
    ),
    "a constant beside": (
        "t,x,a [g]\n" + "".join(f"{t},{x},0\n" for t, x in zip(T, X, strict=True)),
        "column 'a [g]'[g]: the constant 0. Try: --columns \"t=t,x=x\", which reads t 0, ",
    ),
    "no unit": (headed("t,x [blub]"), "column x: 'blub' is not a unit. Try: --columns \"t=t,x='x [blub]'[m]\""),
    "an astronomer's unit": (headed("t,x [parsec]"), "'parsec' is no unit of a machine: 3.086e+16 in SI units. Try: "),
    "an astronomer's unit in --columns": (
        PLAIN,
        "channel x: 'light_year' is no unit of a machine: 9.461e+15 in SI units; expected a unit of length",
        ReadOptions(columns="x=x[light_year]"),
    ),
    "wrong dimension": (headed("t,x [kg]"), f"column x: 'kg' {ANOTHER} (kilogram)"),
    "volts": (headed("t,x [V]"), VOLTS),
    "time in metres": (headed("t [m],x"), f"column t: 'm' {ANOTHER} (meter)"),
    "percent": (headed("t,x [%]"), f"{ANOTHER} (a pure number)"),
    "mil": (headed("t,x [mil]"), "others (thou (0.001 inch) or mrad). Try: --columns \"t=t,x='x [mil]'[thou]\""),
    "rd": (headed("t,v [Rd/s]"), "others (rad, or rod (5.03 m)). Try: --columns \"t=t,v='v [Rd/s]'[rad/s]\""),
    "gram": (headed("t,x [g]"), f"'g' {ANOTHER} (kilogram)"),
    "temperature": (headed("t,x [degC]"), f"'degC' {ANOTHER} (kelvin)"),
    "empty unit": (headed("t,x []"), "'' is not a unit"),
    "no such column": (PLAIN, "column qm: no such column; expected t, x", ReadOptions(columns="x=qm")),
    "no such position": (PLAIN, "column #3: no such column; expected #1 to #2", ReadOptions(columns="x=#3")),
    "twice": (headed("x,x"), "2 columns of this name; expected one of #1, #2", ReadOptions(columns="x=x", rate=1.0)),
    "cut to nothing": (
        PLAIN,
        "0 samples between --from and --to (the file runs from 0 s to 1.995",
        ReadOptions(start=9.0),
    ),
    "lines before numbers without names": (
        ANGLES,
        'the columns #1. Try: --columns "x=#1" --rate HZ',
    ),
    "all skipped": (PLAIN, "--skip-rows: 999 of", ReadOptions(skip_rows=999)),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused_by_name(tmp_path: Path, case: str) -> None:
    content, message, options = (*REFUSED[case], ReadOptions())[:3]
    path = tmp_path / "a.csv"
    path.write_text(content)
    with pytest.raises(InputError) as caught:
        read_recording(path, options)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


BROKEN: list[tuple[str, bytes, str]] = [
    ("a.json", b"{}", "no table in it; expected a list of records"),
    ("b.json", b"{", "not JSON"),
    ("a.xlsx", b"nothing", "not a workbook"),
    ("a.zip", b"nothing", "not an archive"),
    ("a.tdms", b"nothing", "no numeric array in it"),
    ("a.labx", b"nothing", "no whole XML"),
    ("a.cmbl", b"<Document><DataSet>", "no whole XML"),
    ("a.gambl", b"<Document/>", "no numeric array"),
    ("a.wpilog", b"nothing", "not a log of WPILib"),
    ("a.h5", b"nothing", "not an HDF5 file"),
    ("a.doc", b"nothing", "the format .doc; expected text tables, also gzipped (.csv, .txt, "),
    ("a.db3", b"", "and our own .rrd, and a bag of a robot's joints with --robot FILE"),
    ("recording", b"", "the format without a name"),
    ("a.parquet", b"nothing", "not a Parquet file"),
    ("a.mat", b"nothing", "not a MATLAB file"),
    ("b.mat", b"MATLAB 7.3 MAT-file".ljust(600), "not a MATLAB file"),
    ("a.npz", b"nothing", "not an .npz archive"),
    ("a.csv.gz", b"\x1f\x8bnothing", "unreadable"),
    ("a.csv", b"\x00\x01\x02\x03", "binary content"),
    ("b.csv", "t,x\n0,1\n".encode("utf-16-le"), "binary content"),
    ("c.csv", "t,x\n0,1\n".encode("utf-16")[:-1], "UTF-16 that is damaged"),
]


@pytest.mark.parametrize(("name", "content", "message"), BROKEN, ids=[b[0] for b in BROKEN])
def test_broken_files_are_named(tmp_path: Path, name: str, content: bytes, message: str) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=r"expected|Try: ") as caught:
        read_recording(tmp_path / name)
    assert message in str(caught.value)


@pytest.mark.parametrize("coding", ["utf-8-sig", "utf-16", "utf-16-be"])
def test_texts_as_spreadsheets_save_them(tmp_path: Path, coding: str) -> None:
    text = "t [s],Weg \u00b5 [mm]\r\n" + "".join(f"{t},{1e3 * x}\r\n" for t, x in zip(T, X, strict=True))
    mark = b"\xfe\xff" if coding == "utf-16-be" else b""
    (tmp_path / "a.csv").write_bytes(mark + text.encode(coding))
    found = read_recording(tmp_path / "a.csv", ReadOptions(columns="x='Weg \u00b5'"))
    assert found["x"] == pytest.approx(X)


@pytest.mark.parametrize(
    ("first", "second", "apart"),
    [
        ("2026-03-01T00:00:00.000+01:00", "2026-02-28 23:30:00+00:00", 1800.0),
        ("2024-02-28T23:59:59Z", "2024-03-01T00:00:00.000000001Z", 86_401.000000001),
        ("9:59:59", "10:00:00.5", 1.5),
        ("10:00:00,25", "10:00:00,75", 0.5),
        ("2026-12-31 23:59:59.75", "2027-01-01 00:00:00.25", 0.5),
    ],
)
def test_times_of_day_are_counted_from_the_first(first: str, second: str, apart: float) -> None:
    clock = Clock()
    assert clock.seconds(first) == 0.0
    assert clock.seconds(second) == pytest.approx(apart, abs=1e-10)
    assert clock.first == first


@pytest.mark.parametrize("text", ["2026-02-30T10:00:00", "today", "10:00", "2026-11-23", "1.5", ""])
def test_what_is_no_time_of_day_is_none(text: str) -> None:
    assert Clock().seconds(text) is None


def _dated(tmp_path: Path, row: str) -> Path:
    rows = "".join(f"2026-11-23T23:59:{58 + 0.01 * i:06.3f}Z,{x}\n" for i, x in enumerate(X[:199]))
    (tmp_path / "a.csv").write_text(f"time,x [mm]\n{rows}{row}")
    return tmp_path / "a.csv"


def test_a_recording_with_dates(tmp_path: Path) -> None:
    found = read_recording(_dated(tmp_path, "2026-11-24T00:00:00Z,0.5\n"))
    assert found.t == pytest.approx(0.01 * np.r_[np.arange(199), 200], abs=1e-9)
    assert (
        "Times are dates, times of day or spans: t is counted from the first, 2026-11-23T23:59:58.000Z." in found.notes
    )


@pytest.mark.parametrize("unit", ["ns", "us", "ms"])
def test_time_stamps_of_parquet_keep_all_their_digits(tmp_path: Path, unit: str) -> None:
    counts = (1_700_000_000 * 1000 + 3 * np.arange(N)) * int(1e-3 / {"ns": 1e-9, "us": 1e-6, "ms": 1e-3}[unit] + 0.5)
    pq.write_table(pa.table({"time": pa.array(counts, pa.timestamp(unit)), "x [mm]": 1e3 * X}), tmp_path / "a.parquet")
    found = read_recording(tmp_path / "a.parquet")
    assert np.max(np.abs(found.t - 3e-3 * np.arange(N))) < 1e-14 * N
    assert any("counted from the first, 2023-11-14T22:13:20" in note for note in found.notes)


@pytest.mark.parametrize(
    ("kind", "first"),
    [(pa.duration("ns"), "36000 s"), (pa.duration("ms"), "36000 s"), (pa.time32("ms"), "36000 s"),
     (pa.time64("us"), "36000 s")],
)  # fmt: skip
def test_spans_and_times_of_day_of_parquet_are_counted_from_the_first(
    tmp_path: Path, kind: pa.DataType, first: str
) -> None:
    counts = (36_000 * 1000 + 3 * np.arange(N)) * {"ns": 1_000_000, "us": 1000, "ms": 1}[kind.unit]
    whole = pa.array(counts, pa.int64()).cast(pa.int32() if pa.types.is_time32(kind) else pa.int64())
    pq.write_table(pa.table({"time": whole.cast(kind), "x [mm]": 1e3 * X}), tmp_path / "a.parquet")
    found = read_recording(tmp_path / "a.parquet")
    assert np.max(np.abs(found.t - 3e-3 * np.arange(N))) < 1e-14 * N
    assert any(f"counted from the first, {first}." in note for note in found.notes)


UNITS_BELOW = [
    ("Time,Position", "s,mm"),
    ("Time,Position", "(s),(mm)"),
    ("Time;Position", "[s];[mm]\n"),
    ("Time Position", "s mm"),
    ('"Time","Position"', '"s","mm"'),
]


@pytest.mark.parametrize(("head", "units"), UNITS_BELOW)
def test_units_in_a_line_of_their_own(tmp_path: Path, head: str, units: str) -> None:
    mark = next(mark for mark in ";, " if mark in head)
    rows = "".join(f"{t:.6f}{mark}{1e3 * x:.9f}\n" for t, x in zip(T, X, strict=True))
    (tmp_path / "a.csv").write_text(f"{head}\n{units}\n{rows}")
    found = read_recording(tmp_path / "a.csv")
    assert np.allclose(found["x"], X, atol=1e-11)
    assert found.units["x"] == "mm"
    assert len(found) == N


def test_a_line_of_text_is_units_only_between_bare_names_and_numbers(tmp_path: Path) -> None:
    rows = "".join(f"{t:.6f},{x:.9f}\n" for t, x in zip(T, X, strict=True))
    for head, line, message in (
        ("t,x", "s,furlongish", "column x: 'furlongish' is not a unit"),
        ("t [s],x [mm]", "s,mm", "row 1 (line 2), column t: the text 's'"),
    ):
        (tmp_path / "a.csv").write_text(f"{head}\n{line}\n{rows}")
        with pytest.raises(InputError) as caught:
            read_recording(tmp_path / "a.csv")
        assert message in str(caught.value)


def test_numbers_as_fortran_and_typesetters_write_them(tmp_path: Path) -> None:
    fortran = "".join(f"  {t:.9E}  {x:.9E}\n" for t, x in zip(T, X, strict=True)).replace("E", "D")
    (tmp_path / "a.dat").write_text(f"t x\n{fortran}")
    minus = "".join(f"{t:.9f},{x:.12f}\n" for t, x in zip(T, X, strict=True)).replace("-", "\N{MINUS SIGN}")
    (tmp_path / "b.csv").write_text(f"t,x\n{minus}", encoding="utf-8")
    for name in ("a.dat", "b.csv"):
        assert np.allclose(read_recording(tmp_path / name)["x"], X, atol=1e-9)


@pytest.mark.parametrize("text", ["--5", "5D", "D5", "1D2D3", "1e5D2", "\N{MINUS SIGN}", "5 D2"])
def test_what_is_nearly_a_number_is_none(tmp_path: Path, text: str) -> None:
    rows = "".join(f"{t:.6f},{x:.9f}\n" for t, x in zip(T, X, strict=True))
    (tmp_path / "a.csv").write_text(f"t,x\n{rows}9.0,{text}\n")
    with pytest.raises(InputError, match="a number"):
        read_recording(tmp_path / "a.csv")


@pytest.mark.parametrize(
    ("row", "columns", "message"),
    [
        ("12.5,0.5\n", None, "row 200 (line 201), column time: the text '12.5'"),
        ("later,0.5\n", None, "row 200 (line 201), column time: the text 'later'"),
        ("2026-11-24T00:00:00Z,0.5\n", "t=time,x=time", "channel x: the time '2026-11-23T23:59:58.000Z'"),
    ],
)
def test_dates_that_are_none_are_named(tmp_path: Path, row: str, columns: str | None, message: str) -> None:
    with pytest.raises(InputError, match=r"expected|Try: ") as caught:
        read_recording(_dated(tmp_path, row), ReadOptions(columns=columns))
    assert message in str(caught.value)


def test_lengths_that_differ_are_named(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", t=T, x=X[:-1])
    with pytest.raises(InputError, match="400 values of t, 399 values of x"):
        read_recording(tmp_path / "a.npz")


def test_text_columns_of_parquet_are_named(tmp_path: Path) -> None:
    pq.write_table(pa.table({"t": T, "x": [str(x) for x in X]}), tmp_path / "a.parquet")
    with pytest.raises(InputError, match="row 1, column x: a column of type string"):
        read_recording(tmp_path / "a.parquet")


def test_of_columns_of_one_name_the_first_is_read_and_the_last_is_told(tmp_path: Path) -> None:
    t = np.arange(100) * 0.01
    path = tmp_path / "twice.csv"
    np.savetxt(path, np.column_stack((t, np.cos(t), np.sin(t))), "%.6f", ",", header="t,x,x", comments="")
    first = read_recording(path)
    (note,) = first.notes
    last = read_recording(path, ReadOptions(columns=note.split('"')[1]))
    np.testing.assert_allclose(first["x"], np.cos(t), atol=1e-6)
    np.testing.assert_allclose(last["x"], np.sin(t), atol=1e-6)


@pytest.mark.parametrize(
    ("number", "function", "values", "said"),
    [
        ("58", 4, 60, "no time response; expected time responses, data set 58 in ASCII"),
        ("58b", 1, 60, "no time response; expected time responses, data set 58 in ASCII"),
        ("58", 1, 70, "data set 1: damaged (60 of 70 values); expected time responses"),
    ],
)
def test_a_universal_file_without_a_response_is_refused(
    tmp_path: Path, number: str, function: int, values: int, said: str
) -> None:
    head = [
        "    -1",
        f"    {number}",
        *["NONE"] * 5,
        f"{function:5}{1:10}",
        f"{2:10}{values:10}{1:10}{0.0:13.5e}{0.01:13.5e}",
    ]
    axes = [f"{kind:10}{0:5}{0:5}{0:5} {'NONE':20} {'NONE':20}" for kind in (17, 8, 0, 0)]
    rows = ["".join(f"{v:13.5e}" for v in X[i : i + 6]) for i in range(0, 60, 6)]
    path = tmp_path / "modal.uff"
    path.write_text("\n".join([*head, *axes, *rows, "    -1"]))
    with pytest.raises(InputError) as caught:
        read_recording(path)
    assert said in str(caught.value)
