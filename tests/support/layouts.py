"""Recordings of one motion as other programs write them, with their traps; what should be read stands beside each.

Each writer gets a folder, the motion and a generator, and gives the file and what is wanted of it, in SI.
"""

import io
import json
import struct
import tarfile
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
import scipy.io

Wanted = Mapping[str, np.ndarray]


@dataclass(frozen=True)
class Motion:
    """A free decay: t (n,), s; x, v, a in m or rad and their derivatives; all of them as written to so many digits."""

    t: np.ndarray
    x: np.ndarray
    v: np.ndarray
    a: np.ndarray


def drawn(rng: np.random.Generator) -> Motion:
    """A decay of some ten cycles, at rest before it is let go."""
    n, rate = int(rng.integers(500, 900)), float(rng.choice([50.0, 100.0, 200.0]))
    t = np.arange(n) / rate
    w, zeta, x0 = 2.0 * np.pi * 10.0 / t[-1], rng.uniform(0.005, 0.03), rng.uniform(0.05, 0.4)
    pole = complex(-zeta, np.sqrt(1.0 - zeta**2)) * w
    z = x0 * np.exp(pole * t)
    return Motion(t, z.real, (pole * z).real, (pole * pole * z).real)


def lines(path: Path, *text: str, end: str = "\n") -> Path:
    path.write_text(end.join(text) + end, encoding="utf-8")
    return path


def rows(separator: str, *columns: np.ndarray, digits: str = "%.6f", comma: bool = False) -> list[str]:
    """Numbers as text; nan is left blank."""
    table = np.stack(columns, axis=1)
    said = [["" if np.isnan(v) else digits % v for v in row] for row in table]
    return [separator.join(cell.replace(".", ",") if comma else cell for cell in row) for row in said]


def _axes(m: np.ndarray, rng: np.random.Generator) -> list[np.ndarray]:
    """Three axes of a sensor, of which one sees the motion."""
    noise = 0.02 * np.std(m) * rng.standard_normal((3, m.size))
    noise[1] += m
    return [*noise, np.sqrt(np.sum(noise**2, axis=0))]


def phyphox_gyroscope(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    names = [*(f"Gyroscope {c} (rad/s)" for c in "xyz"), "Absolute (rad/s)"]
    axes = _axes(m.v, rng)
    head = ",".join(f'"{name}"' for name in ["Time (s)", *names])
    return lines(folder / "Raw Data.csv", head, *rows(",", m.t, *axes, digits="%.9E")), {"t": m.t, "v": axes[1]}


def phyphox_german(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    names = [f"Lineare Beschleunigung {c} (m/s^2)" for c in "xyz"]
    axes = _axes(m.a, rng)
    head = ";".join(f'"{name}"' for name in ["Zeit (s)", *names, "Absolute Beschleunigung (m/s^2)"])
    body = rows(";", m.t, *axes, digits="%.9E", comma=True)
    return lines(folder / "Rohdaten.csv", head, *body), {"t": m.t, "a": axes[1]}


def _runs(m: Motion, rng: np.random.Generator, count: int = 3) -> list[Motion]:
    """Repetitions, the first the longest."""
    sizes = [m.t.size, *(int(m.t.size * rng.uniform(0.6, 0.95)) for _ in range(count - 1))]
    found: list[Motion] = []
    for size in sizes:
        k = 1.0 if not found else rng.uniform(0.7, 1.2)
        parts = [
            np.pad(y[:size].astype(float), (0, m.t.size - size), constant_values=np.nan) for y in (m.t, m.x, m.v, m.a)
        ]
        found.append(Motion(parts[0], k * parts[1], k * parts[2], k * parts[3]))
    return found


def vernier_runs(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    runs = _runs(m, rng)
    head = ",".join(f"Run {k}: Time (s),Run {k}: Position (m)" for k in range(1, 4))
    body = rows(",", *(y for run in runs for y in (run.t, run.x)))
    return lines(folder / "all.csv", head, *body), {"t": m.t, "x": m.x}


def graphical_analysis(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    runs = _runs(m, rng, 2)
    head = ",".join(
        f"Data Set {k}:Time(s),Data Set {k}:Angle(rad),Data Set {k}:Angular Velocity(rad/s)" for k in (1, 2)
    )
    body = rows(",", *(y for run in runs for y in (run.t, run.x, run.v)))
    return lines(folder / "ga.csv", head, *body), {"t": m.t, "x": m.x, "v": m.v}


def logger_pro_latest(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    head = "Latest: Time (s),Latest: Position (m),Latest: Velocity (m/s),Latest: Acceleration (m/s²)"
    return lines(folder / "latest.csv", head, *rows(",", m.t, m.x, m.v, m.a)), {"t": m.t, "x": m.x, "v": m.v, "a": m.a}


def logger_pro_text(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    head = ["Vernier Format 2", "pendulum.cmbl 3/14/2023 15:09:26 .", "Run 1", "Time\tPosition\tVelocity", "T\tX\tV"]
    body = [line + "\t" for line in rows("\t", m.t, 100.0 * m.x, 100.0 * m.v)]
    return lines(folder / "run.txt", *head, "s\tcm\tcm/s", "", *body, end="\r\n"), {"t": m.t, "x": m.x, "v": m.v}


def capstone(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    runs = _runs(m, rng, 2)
    names = ("Time (s)", "Angle, Ch P1 (rad)", "Angular Velocity, Ch P1 (rad/s)")
    head = ",".join(f'"{name} Run #{k}"' for k in (1, 2) for name in names)
    body = rows(",", *(y for run in runs for y in (run.t, run.x, run.v)), digits="%.5f")
    return lines(folder / "capstone.csv", head, *body), {"t": m.t, "x": m.x, "v": m.v}


def arduino_banner(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    counts, start = np.round(512.0 + 1000.0 * m.x), int(rng.integers(900, 5000))
    body = rows(",", np.round(1e3 * m.t) + start, counts, digits="%d")
    path = lines(folder / "serial.log", "v1.3.2", "HX711 ready", "millis,adc", *body)
    path.write_text(path.read_text() + body[-1][: len(body[-1]) // 2])
    return path, {"t": m.t + start / 1e3, "x": counts}


def arduino_monitor(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    said = [
        f"14:{3 + int((11 + t) // 60):02d}:{(11 + t) % 60:06.3f} -> {1e3 * x:.2f}"
        for t, x in zip(m.t, m.x, strict=True)
    ]
    return lines(folder / "monitor.txt", *said), {"t": m.t, "x": np.round(1e3 * m.x, 2)}


def arduino_plotter(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    said = [f"t_ms:{1e3 * t:.0f} pos_mm:{1e3 * x:.3f}" for t, x in zip(m.t, m.x, strict=True)]
    return lines(folder / "plotter.txt", *said), {"t": m.t, "x": m.x}


def _lvm(m: Motion, times: bool, comma: bool, labels: tuple[str, str]) -> list[str]:
    step = f"{m.t[1]:.6f}"

    def two(word: str) -> str:
        return f"{word}\t{word}"

    zero = "0.0000000000000000E+0"
    head = ["LabVIEW Measurement\t", "Writer_Version\t2", "Reader_Version\t2", "Separator\tTab"]
    head += [
        f"Decimal_Separator\t{',' if comma else '.'}",
        "Multi_Headings\tNo",
        f"X_Columns\t{'One' if times else 'No'}",
    ]
    head += [
        "Time_Pref\tRelative",
        "Operator\tlab",
        "Date\t2021/03/04",
        "Time\t10:11:12,1234567",
        "***End_of_Header***\t",
        "",
    ]
    head += [
        "Channels\t2\t\t",
        f"Samples\t{two(str(m.t.size))}\t",
        f"Date\t{two('2021/03/04')}\t",
        f"Y_Unit_Label\t{labels[0]}\t{labels[1]}\t",
    ]
    head += [
        f"X_Dimension\t{two('Time')}\t",
        f"X0\t{two(zero)}\t",
        f"Delta_X\t{two(step)}\t",
        "***End_of_Header***\t\t\t",
    ]
    head = [line.replace(".", ",") if comma and line.startswith(("X0", "Delta")) else line for line in head]
    return [*head, "X_Value\tPosition\tAcceleration\tComment"]


def labview(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    body = rows("\t", m.t, 1e3 * m.x, m.a)
    return lines(folder / "a.lvm", *_lvm(m, True, False, ("mm", "m/s^2")), *body), {"t": m.t, "x": m.x, "a": m.a}


def labview_by_step(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    body = rows("\t", np.nan * m.t, m.x, m.a, digits="%.7f", comma=True)
    return lines(folder / "a.txt", *_lvm(m, False, True, ("m", "m/s^2")), *body), {"t": m.t, "x": m.x, "a": m.a}


def cassy(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    head = ["\ufeffMIN=0\t-5", "MAX=60\t5", "SCALE=60\t5", "DEC=1\t3", 'DEF="Zeit" t / s\t"Winkel" &a / °']
    body = rows("\t", m.t, np.rad2deg(m.x), digits="%.7g", comma=True)
    return lines(folder / "cassy.txt", *head, *body), {"t": m.t, "x": m.x}


def tracker(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """What hangs on a spring moves along y; the zero is that of the picture."""
    beside = 1e-3 * rng.standard_normal(m.t.size)
    mark = str(rng.choice(["\t", ","]))
    body = rows(mark, m.t, 0.213 + beside, m.x - 0.11, digits="%.6E")
    return lines(folder / "tracker.txt", "mass_A", mark.join("txy"), *body), {"t": m.t, "x": m.x - 0.11}


def odrive(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    t = np.cumsum(rng.uniform(0.02, 0.08, m.t.size))
    names = [f"ODrive {k} {word}" for word in ("Position", "Velocity", "Current") for k in range(4)]
    none, still = np.full(t.size, np.nan), np.full(t.size, 1.7)
    columns = [none, still, m.x, none, none, 0.0 * t, m.v, none, none, 0.02 + 0.0 * t, 0.1 * m.a, none]
    body = [line.replace(",,", ",NaN,").replace(",,", ",NaN,") for line in rows(",", t, *columns)]
    wanted = {"t": t, "x": 2.0 * np.pi * m.x, "v": 2.0 * np.pi * m.v}
    return lines(folder / "odrive.csv", ",".join(["time", *names]), *body), wanted


def picoscope(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    body = rows(",", 1e3 * m.t, m.a / 9.80665)
    body[7] = body[7].partition(",")[0] + ",∞"
    keep = np.arange(m.t.size) != 7
    return lines(folder / "pico.csv", "Time,Channel A", "(ms),(g)", "", *body), {"t": m.t[keep], "a": m.a[keep]}


def mujoco(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    body = rows(",", m.t, m.x, m.v, m.a, digits="%.9g")
    return lines(folder / "sim.csv", "time,qpos,qvel,qacc", *body), {"t": m.t, "x": m.x, "v": m.v, "a": m.a}


def microcontroller(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """No names, whole ms, one step back."""
    ms = np.round(1e3 * m.t)
    at = int(rng.integers(100, 300))
    ms[at] = ms[at - 1] - 3
    keep = np.arange(ms.size) != at
    return lines(folder / "data.txt", *rows("\t", ms, 1e3 * m.x, digits="%.0f")), {
        "t": ms[keep] / 1e3,
        "x": np.round(1e3 * m.x)[keep],
    }


def rig(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Two lines of text, names, units, comments, duplicates, empty cells, a gap, a trailing line of units."""
    t = m.t + 0.095 * (m.t > m.t[300])
    body = rows(",", t, 1e3 * m.x, digits="%.5f")
    lost = np.isin(np.arange(t.size), [120, 131])
    body = [line.partition(",")[0] + "," if gone else line for line, gone in zip(body, lost, strict=True)]
    body[40:40] = ["# belt slipped", body[39], body[39]]
    text = ["# Rig 4, operator AB", "# sampling 200 Hz", "Time,Displacement", "(s),(mm)", *body, "(s),(mm)"]
    return lines(folder / "rig.csv", *text), {"t": t[~lost], "x": m.x[~lost]}


NAMES = [
    ("Zeit [s]", "Auslenkung [mm]"), ("temps (s)", "déplacement (mm)"), ("tiempo;s", "posición;mm"),
    ("tempo /s", "spostamento /mm"), ("tijd in s", "verplaatsing in mm"), ("czas [s]", "położenie [mm]"),
    ("时间 (s)", "位移 (mm)"), ("время, s", "смещение, mm"), ("tid (s)", "läge (mm)"), ("čas [s]", "poloha [mm]"),
    ("zaman (s)", "konum (mm)"), ("時間[s]", "変位[mm]"),
]  # fmt: skip


def languages(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    t, x = NAMES[int(rng.integers(len(NAMES)))]
    head = [f"{t}|{x}".replace(";", "|").replace("|", "\t")] if ";" not in t else [f"{t[:6]}\t{x[:8]}", "s\tmm"]
    other = 20.0 + 0.01 * rng.standard_normal(m.t.size)
    head[0] += "\tT"
    head[1:] = [line + "\t°C" for line in head[1:]]
    return lines(folder / "a.txt", *head, *rows("\t", m.t, 1e3 * m.x, other)), {"t": m.t, "x": m.x}


def water_pendulum(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Runs side by side, stamps of three digits, degrees that no name tells."""
    runs = _runs(m, rng)
    head = ";".join(f"t{k};theta{k};omega{k}" for k in (1, 2, 3))
    scale = 40.0 / np.max(m.x)
    body = rows(";", *(y for run in runs for y in (run.t, scale * run.x, scale * run.v)), digits="%.2E")
    return lines(folder / "runs.csv", head, *body), {
        "t": m.t,
        "x": np.deg2rad(scale * m.x),
        "v": np.deg2rad(scale * m.v),
    }


def sensor_logger(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    axes = _axes(m.v, rng)
    stamps = [f"{1_700_000_000_000_000_000 + round(1e9 * t)}" for t in m.t]
    body = [f"{ns},{rest}" for ns, rest in zip(stamps, rows(",", m.t, axes[2], axes[1], axes[0]), strict=True)]
    return lines(folder / "Gyroscope.csv", "time,seconds_elapsed,z,y,x", *body), {"t": m.t, "v": axes[1]}


def catman(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    head = ["HBM_CATMANEASYDATAFILE_003", "T0 = 01.02.2023 10:11:12", "", "Zeit  1 - Standardmessrate\tWegaufnehmer"]
    head += ["s \tmm ", "SR=100 HZ\tMX840", "Standardmessrate\tSensor LVDT 5mm"]
    return lines(folder / "a.asc", *head, *rows("\t", m.t, 1e3 * m.x, comma=True), end="\r\n"), {"t": m.t, "x": m.x}


def polytec(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    head = ["Source File Name:\tscan.pvd", "Point Index:\t1", "Signal:\tVib - Velocity - Samples", ""]
    body = rows("\t", m.t, m.v, digits="%.7e")
    return lines(folder / "a.txt", *head, "Time\tVelocity", "[ s ]\t[ mm/s ]", *body), {"t": m.t, "v": 1e-3 * m.v}


def feels_its_weight(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Three accelerations of no unit but that of the weight that one of them feels."""
    factor = {"g": 1 / 9.80665, "mm": 1e3, "m": 1.0}[str(rng.choice(["g", "mm", "m"]))]
    noise = 0.05 * rng.standard_normal((2, m.t.size))
    columns = [factor * m.a, factor * noise[0], factor * (9.80665 + noise[1])]
    return lines(folder / "a.csv", "#time,accel_x,accel_y,accel_z", *rows(",", m.t, *columns)), {"t": m.t, "a": m.a}


def times_of_day(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    ms = [round(1e3 * t) for t in m.t]
    clock = [f"10:{11 + k // 60000:02d}:{k // 1000 % 60:02d}" for k in ms]
    kind = int(rng.integers(3))
    head = ["Zeitstempel;Weg / mm", "Datum;Uhrzeit;Weg / mm", "Timestamp;Position (mm)"][kind]
    stamp = ["01.02.2023 {0}.{1:03d}", "01.02.2023;{0},{1:03d}", "2/1/2023 {0}.{1:03d} AM"][kind]
    body = rows(";", 1e3 * m.x, comma=kind < 2)
    said = [f"{stamp.format(s, k % 1000)};{x}" for s, k, x in zip(clock, ms, body, strict=True)]
    return lines(folder / "a.csv", head, *said), {"t": m.t, "x": m.x}


def printed(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    said = [f"t={1e3 * t:.0f} ms, angle={np.rad2deg(x):.4f} deg" for t, x in zip(m.t, m.x, strict=True)]
    return lines(folder / "port.log", "Booting...", "IMU OK", *said), {"t": m.t, "x": m.x}


def stamps_in_two(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Seconds and nanoseconds of a message's header, names with points, an axis of three that moves."""
    ns = [1_700_000_000_250_000_000 + round(1e9 * t) for t in m.t]
    still = 1e-3 * rng.standard_normal((2, m.t.size))
    axes = rows(",", m.x, 1.0 + still[0], still[1], m.v, digits="%.7f")
    said = [f"{k // 10**9},{k % 10**9},{rest}" for k, rest in zip(ns, axes, strict=True)]
    names = [f"pose.position.{axis}" for axis in "xyz"]
    head = ",".join(["header.stamp.sec", "header.stamp.nanosec", *names, "twist.velocity.x"])
    return lines(folder / "pose.csv", head, *said), {"t": m.t, "x": m.x, "v": m.v}


def whole_seconds_and_the_rest(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """A controller's stamps under one front, ZeitSec and ZeitNanoSec."""
    ns = [1_700_000_000_250_000_000 + round(1e9 * t) for t in m.t]
    said = [f"{k // 10**9};{k % 10**9};{x:.7f}" for k, x in zip(ns, m.x, strict=True)]
    return lines(folder / "trace.csv", "ZeitSec;ZeitNanoSec;Position [m]", *said), {"t": m.t, "x": m.x}


def with_a_summary(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """An overload in two cells, and means below the rows."""
    body = rows(",", m.t, 1e3 * m.x)
    body[50:52] = [line.partition(",")[0] + ",OVERLOAD" for line in body[50:52]]
    keep = ~np.isin(np.arange(m.t.size), [50, 51])
    path = lines(folder / "a.csv", "Time [s],Weg [mm]", *body, "", "Mean,0.001", "Std,0.12")
    return path, {"t": m.t[keep], "x": m.x[keep]}


def phyphox_zip(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    text, wanted = phyphox_gyroscope(folder, m, rng)
    path = folder / "Gyroscope.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.write(text, "Raw Data.csv")
        archive.writestr("meta/device.csv", '"property","value"\n"version","1.1.11"\n')
        archive.writestr("meta/time.csv", '"event","experiment time"\n"START",0.0E0\n"PAUSE",3.1E1\n')
    return path, wanted


def phyphox_excel(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    import openpyxl

    book, axes = openpyxl.Workbook(), _axes(m.v, rng)
    sheet = book.active
    assert sheet is not None
    sheet.title = "Raw Data"
    sheet.append(["Time (s)", *(f"Gyroscope {c} (rad/s)" for c in "xyz"), "Absolute (rad/s)"])
    for row in zip(m.t, *axes, strict=True):
        sheet.append([float(v) for v in row])
    about = book.create_sheet("Metadata Device")
    about.append(["property", "value"])
    about.append(["deviceModel", "XQ-BC52"])
    book.save(folder / "Gyroscope.xlsx")
    return folder / "Gyroscope.xlsx", {"t": m.t, "v": axes[1]}


def excel_by_hand(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """A title, an empty row, names, units, numbers, a remark beside them."""
    import openpyxl

    book = openpyxl.Workbook()
    sheet = book.active
    assert sheet is not None
    for row in (["Experiment 3"], [], ["Zeit", "Winkel", "T"], ["s", "°", "°C"]):
        sheet.append(row)
    for t, x in zip(m.t, np.rad2deg(m.x), strict=True):
        sheet.append([float(t), float(x), 21.5])
    book.save(folder / "a.xlsx")
    return folder / "a.xlsx", {"t": m.t, "x": m.x}


def labx(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    def channel(quantity: str, symbol: str, unit: str, y: np.ndarray) -> str:
        values = "".join(f"<value>{v:.9g}</value>" for v in y)
        about = f"<quantity>{quantity}</quantity><symbol>{symbol}</symbol><unit>{unit}</unit>"
        return f'<channel>{about}<values count="{y.size}">{values}</values></channel>'

    count = channel("Index", "n", "", np.arange(1.0, m.t.size + 1.0))
    body = count + channel("Zeit", "t", "s", m.t) + channel("Weg", "s_A1", "mm", 1e3 * m.x)
    head = '<?xml version="1.0" encoding="utf-8"?><cassylab version="2.0"><allchannels count="1"><channels count="3">'
    return lines(folder / "a.labx", f"{head}{body}</channels></allchannels></cassylab>"), {"t": m.t, "x": m.x}


def _vernier(runs: list[Motion]) -> str:
    def column(name: str, unit: str, y: np.ndarray) -> str:
        cells = "\n".join(f"{v:.9g}" for v in y if not np.isnan(v))
        about = f"<ID>7 </ID><DataObjectName>{name}</DataObjectName><ColumnUnits>{unit}</ColumnUnits>"
        return f"<DataColumn>{about}<ColumnCells>\n{cells}\n</ColumnCells></DataColumn>"

    sets = "".join(
        f"<DataSet><DataSetName>Run</DataSetName>{column('Time', 's', run.t)}{column('Position', 'm', run.x)}</DataSet>"
        for run in runs
    )
    return f"<Document><FileIDString>Logger Pro Document</FileIDString>{sets}</Document>"


def logger_pro(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    return lines(folder / "pendulum.cmbl", _vernier([m])), {"t": m.t, "x": m.x}


def graphical_analysis_archive(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    text, path = _vernier(_runs(m, rng)).encode(), folder / "cart.gambl"
    with tarfile.open(path, "w") as archive:
        about = tarfile.TarInfo("vstudm/data.udm")
        about.size = len(text)
        archive.addfile(about, io.BytesIO(text))
    return path, {"t": m.t, "x": m.x}


def wpilog(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Entries of a drive, and a battery's voltage ten times slower; cut short in the middle of a record."""

    def record(entry: int, us: int, payload: bytes) -> bytes:
        return bytes([0b0111_00_00 | (1 << 2)]) + struct.pack("<BHQ", entry, len(payload), us) + payload

    def start(entry: int, name: str, kind: str) -> bytes:
        texts = b"".join(struct.pack("<I", len(one)) + one.encode() for one in (name, kind, ""))
        return record(0, 0, b"\x00" + struct.pack("<I", entry) + texts)

    data = b"WPILOG" + struct.pack("<HI", 0x0100, 0)
    for entry, name in enumerate(("/arm/position", "/arm/velocity", "/battery"), 1):
        data += start(entry, name, "double")
    for k, t in enumerate(m.t):
        us = round(1e6 * t) + 4_000_000
        data += record(1, us, struct.pack("<d", m.x[k])) + record(2, us, struct.pack("<d", m.v[k]))
        data += record(3, us, struct.pack("<d", 12.0 + 0.01 * rng.standard_normal())) if k % 10 == 0 else b""
    (folder / "FRC.wpilog").write_bytes(data + data[-20:-4])
    return folder / "FRC.wpilog", {"t": m.t, "x": m.x, "v": m.v}


def tdms(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    from nptdms import ChannelObject, TdmsWriter

    about = {"wf_increment": float(m.t[1]), "wf_start_offset": 0.0}
    with TdmsWriter(str(folder / "a.tdms")) as file:
        file.write_segment(
            [
                ChannelObject("Measured", "Displacement", 1e3 * m.x, {**about, "unit_string": "mm"}),
                ChannelObject("Measured", "Accelerometer", m.a / 9.80665, {**about, "unit_string": "g"}),
            ]
        )
    return folder / "a.tdms", {"t": m.t, "x": m.x, "a": m.a}


def matlab_rows(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    scipy.io.savemat(folder / "a.mat", {"Fe": {"Out": {"Time": m.t, "Acc": np.stack([0.1 * m.a, m.a])}}})
    return folder / "a.mat", {"t": m.t, "a": m.a}


def matlab_trials(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    trial = np.zeros(2, dtype=[("time", object), ("theta", object)])
    for k in range(2):
        trial[k]["time"], trial[k]["theta"] = m.t[: m.t.size - 50 * k], m.x[: m.t.size - 50 * k]
    scipy.io.savemat(folder / "a.mat", {"trial": trial, "fs": 100.0})
    return folder / "a.mat", {"t": m.t, "x": m.x}


def simulink(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    signals = {"values": m.x[:, None], "dimensions": 1.0, "label": "angle"}
    scipy.io.savemat(folder / "a.mat", {"simout": {"time": m.t[:, None], "signals": signals, "blockName": "m/To"}})
    return folder / "a.mat", {"t": m.t, "x": m.x}


def hdf5(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    with h5py.File(folder / "a.h5", "w") as file:
        for name, unit, values in (
            ("time", "ms", 1e3 * m.t),
            ("angle", "deg", np.rad2deg(m.x)),
            ("rate", "deg/s", np.rad2deg(m.v)),
        ):
            file[f"run/{name}"] = values
            file[f"run/{name}"].attrs["units"] = unit
    return folder / "a.h5", {"t": m.t, "x": m.x, "v": m.v}


def json_lines(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    rows = zip(m.t, m.x, m.v, strict=True)
    said = [json.dumps({"ts": 1.7e9 + t, "joint": {"pos_rad": x, "vel_rad_s": v}, "ok": True}) for t, x, v in rows]
    return lines(folder / "log.jsonl", *said), {"t": m.t, "x": m.x, "v": m.v}


def json_entries(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    rows = zip(m.t, m.x, m.v, strict=True)
    entries = [{"position": x, "speed": v, "temp": 29, "timestamp": t, "goal_position": np.cos(t)} for t, x, v in rows]
    path = folder / "log.json"
    path.write_text(json.dumps({"mass": 0.49, "motor": "xl330", "entries": entries}))
    return path, {"t": m.t, "x": m.x, "v": m.v}


def runs_below(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Runs one under another: each begins at nought again."""
    half = m.t.size // 2
    t, x = np.concatenate([m.t, m.t[:half]]), np.concatenate([m.x, 0.8 * m.x[:half]])
    run = np.repeat([1.0, 2.0], [m.t.size, half])
    return lines(folder / "runs.csv", "trial,time [s],pos [m]", *rows(",", run, t, x)), {"t": m.t, "x": m.x}


def _hhmmss(t: np.ndarray) -> list[str]:
    """Times of day from 9:59:57 on, as Racelogic writes them."""
    ms = [35_997_000 + round(1e3 * float(one)) for one in t]
    return [f"{k // 3_600_000:02d}{k // 60_000 % 60:02d}{k // 1000 % 60:02d}.{k % 1000:03d}" for k in ms]


def vbox(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    v = 20.0 + m.v
    named = ["satellites", "time", "latitude", "longitude", "velocity kmh", "heading", "vertical velocity kmh"]
    head = ["File created on 05/01/2024 at 09:59:57", "", "[header]", *named, "", "[comments]", *["Log rate"] * 60, ""]
    head += ["[column names]", "sats time lat long velocity heading vert-vel", "", "[data]"]
    upward = 0.3 * rng.standard_normal(v.size)
    body = [
        f"009 {clock} +3119.09973 -00058.49277 {3.6 * one:08.4f} 243.11 {up:+.3f}"
        for clock, one, up in zip(_hhmmss(m.t), v, upward, strict=True)
    ]
    return lines(folder / "coast.vbo", *head, *body, end="\r\n"), {"t": m.t, "v": v}


def vbox_table(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    body = [f"{clock};{3.6 * one:.5f}".replace(".", ",") for clock, one in zip(_hhmmss(m.t), 20.0 + m.v, strict=True)]
    return lines(folder / "vbox.csv", "Time [HHMMSS.SSS];Speed [km/h]", *body), {"t": m.t, "v": 20.0 + m.v}


def moteus(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    turn, nought = 2.0 * np.pi, np.zeros(m.t.size)
    body = rows(",", m.t, nought, m.x / turn, m.v / turn, nought, nought, digits="%.8f")
    head = "time,mode,position,velocity,torque,q_current"
    return lines(folder / "moteus.csv", head, *body), {"t": m.t, "x": m.x, "v": m.v}


def sysid(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    turn = 2.0 * np.pi
    tests = {}
    for k, name in enumerate(("fast-backward", "fast-forward", "slow-backward", "slow-forward")):
        table = np.stack((m.t, 0.0 * m.t + k, (1 + k) * m.x / turn, (1 + k) * m.v / turn), axis=1)
        tests[name] = table[: m.t.size - k].tolist()
    about = {"sysid": True, "test": "Simple", "units": "Rotations", "unitsPerRotation": 1.0}
    return lines(folder / "sysid_data.json", json.dumps({**tests, **about})), {"t": m.t, "x": m.x, "v": m.v}


Writer = Callable[[Path, Motion, np.random.Generator], tuple[Path, Wanted]]


def physics_toolbox(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    axes = _axes(m.a, rng)
    head = "time,ax (m/s^2),ay (m/s^2),az (m/s^2),aT (m/s^2)"
    return lines(folder / "linear.csv", head, *rows(",", m.t, *axes)), {"t": m.t, "a": axes[1]}


def motive(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    head = [
        "Format Version,1.23,Take Name,Take 1,Capture Frame Rate,100.0,Rotation Type,Quaternion,Length Units,Meters",
        "", ",Type,Rigid Body,Rigid Body,Rigid Body", ",Name,Cart,Cart,Cart", ",ID,1,1,1",
        ",,Position,Position,Position", "Frame,Time (Seconds),X,Y,Z",
    ]  # fmt: skip
    still = [0.5 + 1e-5 * rng.standard_normal(m.t.size) for _ in "yz"]
    body = [f"{i},{row}" for i, row in enumerate(rows(",", m.t, m.x, *still))]
    return lines(folder / "take.csv", *head, *body), {"t": m.t, "x": m.x}


def qualisys(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    head = [
        f"NO_OF_FRAMES\t{m.t.size}", "NO_OF_CAMERAS\t8", "NO_OF_MARKERS\t1", f"FREQUENCY\t{1.0 / m.t[1]:g}",
        "NO_OF_ANALOG\t0", "DESCRIPTION\t--", "DATA_INCLUDED\t3D", "MARKER_NAMES\tcart",
    ]  # fmt: skip
    still = [500.0 + 0.01 * rng.standard_normal(m.t.size) for _ in "yz"]
    return lines(folder / "trial.tsv", *head, *rows("\t", 1e3 * m.x, *still)), {"t": m.t, "x": m.x}


def vicon(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    head = ["Trajectories", f"{1.0 / m.t[1]:g}", ",,Rig:cart,,", "Frame,Sub Frame,X,Y,Z", ",,mm,mm,mm"]
    still = [500.0 + 0.01 * rng.standard_normal(m.t.size) for _ in "yz"]
    body = [f"{i},0,{row}" for i, row in enumerate(rows(",", 1e3 * m.x, *still), 1)]
    return lines(folder / "trial.csv", *head, *body), {"t": m.t, "x": m.x}


def xsens(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    head = [
        "// Start Time: Unknown", f"// Update Rate: {1.0 / m.t[1]:.1f}Hz",
        "PacketCounter\tSampleTimeFine\tAcc_X\tAcc_Y\tAcc_Z\tGyr_X\tGyr_Y\tGyr_Z",
    ]  # fmt: skip
    gyro, still = _axes(m.v, rng), [0.01 * rng.standard_normal(m.t.size) for _ in "xyz"]
    still[2] += 9.81
    body = rows("\t", *still, *gyro[:3])
    counted = [f"{i % 65536}\t{int(1e4 * t)}\t{row}" for i, (t, row) in enumerate(zip(m.t, body, strict=True))]
    return lines(folder / "MT_0.txt", *head, *counted), {"t": m.t, "v": gyro[1]}


def timetable(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    body = [f"{t:g} sec,{x:.6f}" for t, x in zip(m.t, m.x, strict=True)]
    return lines(folder / "timetable.csv", "Time,position", *body), {"t": m.t, "x": m.x}


def tektronix(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    beside = ["Record Length,2500,Points", "Sample Interval,.004,s", "Vertical Units,mm,", "Firmware,v22.01,"]
    body = [f"{beside[i] if i < len(beside) else ',,'},{row}" for i, row in enumerate(rows(",", m.t, 1e3 * m.x))]
    return lines(folder / "F0001CH1.CSV", *body), {"t": m.t, "x": m.x}


def imu_in_g(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    a = 0.3 * m.a / np.abs(m.a).max() * 9.80665
    still = [0.001 * rng.standard_normal(m.t.size) for _ in "yz"]
    still[1] += 1.0
    body = [f"{1e6 * t:.0f},{row}" for t, row in zip(m.t, rows(",", a / 9.80665, *still), strict=True)]
    return lines(folder / "imu.csv", "t_us,acc_x_g,acc_y_g,acc_z_g", *body), {"t": m.t, "a": a}


def french(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    return lines(folder / "ressort.csv", "Temps (s);Abscisse (m)", *rows(";", m.t, m.x, comma=True)), {
        "t": m.t,
        "x": m.x,
    }


def tachometer(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    rpm = 1500.0 * np.exp(-2.0 * m.t / m.t[-1])
    return lines(folder / "run.csv", "time_s,rpm", *rows(",", m.t, rpm)), {"t": m.t, "v": rpm * 2.0 * np.pi / 60.0}


def _local(numbers: np.ndarray, digits: int, thousands: str, decimal: str) -> list[str]:
    """Numbers with their thousands parted."""
    return [f"{one:,.{digits}f}".translate(str.maketrans(",.", thousands + decimal)) for one in numbers]


def thousands_parted(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """As a German, an English and a Swiss spreadsheet print whole ms and tenths of a µm."""
    thousands, decimal = [(".", ","), (",", "."), ("'", ".")][int(rng.integers(3))]
    cells = zip(_local(1e3 * m.t, 0, thousands, decimal), _local(1e6 * m.x, 1, thousands, decimal), strict=True)
    body = [f"{t};{x}" for t, x in cells]
    return lines(folder / "tabelle.csv", "Zeit (ms);Weg (µm)", *body), {"t": m.t, "x": m.x}


def motive_in_mm(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    path, _ = motive(folder, m, rng)
    text = path.read_text(encoding="utf-8").replace("Length Units,Meters", "Length Units,Millimeters")
    path.write_text(text, encoding="utf-8")
    return path, {"t": m.t, "x": 1e-3 * m.x}


def twincat(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    head = [
        "Name\tScope Project", "File\tYT Scope.tcscopex", "Starttime of export\t133545678901230000", "",
        "Name\tActPos\tName\tActVelo", "SymbolComment\t\tSymbolComment\t", "Data-Type\tREAL64\tData-Type\tREAL64",
        "SampleTime[ms]\t5\tSampleTime[ms]\t5", "VariableSize\t8\tVariableSize\t8", "Port\t501\tPort\t501",
        "Offset\t0\tOffset\t0", "ScaleFactor\t1\tScaleFactor\t1", "",
    ]  # fmt: skip
    body = rows("\t", 1e3 * m.t, m.x, 1e3 * m.t, m.v)
    return lines(folder / "scope.csv", *head, *body), {"t": m.t, "x": m.x, "v": m.v}


def odrive_gui(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    axis = "odrv0.axis0.pos_vel_mapper"
    head = f"time (ms),{axis}.pos_rel,{axis}.vel,odrv0.axis0.motor.foc.Iq_measured"
    wanted = {"t": m.t, "x": 2.0 * np.pi * m.x, "v": 2.0 * np.pi * m.v}
    return lines(folder / "gui.csv", head, *rows(",", 1e3 * m.t, m.x, m.v, 0.1 * m.a)), wanted


def mso(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Settings in pairs, as wide as the rows; what was measured has a unit of the user's."""
    head = [
        "Model,MSO44", "Label,Laser", "Waveform Type,ANALOG", "Horizontal Units,s", "Sample Interval,5e-03",
        f"Record Length,{m.t.size}", "Zero Index,100", "Vertical Units,mm", "FastFrame Count,1", "",
        "TIME [s],CH1 [mm]",
    ]  # fmt: skip
    return lines(folder / "tek0001.csv", *head, *rows(",", m.t - 1.0, 1e3 * m.x, digits="%.7e")), {"t": m.t, "x": m.x}


def boards_log(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Lines behind the stamps of ESP-IDF, of a kernel, of Zephyr and of Python's logger."""
    ms = np.round(1e3 * m.t).astype(int)
    clock = [f"{k // 60000:02d}:{k // 1000 % 60:02d}" for k in ms]
    stamps = {
        "esp": [f"I ({k}) enc:" for k in ms],
        "kernel": [f"[{1e-3 * k:12.6f}] enc:" for k in ms],
        "zephyr": [f"[00:{c}.{k % 1000:03d},000] <inf> main:" for c, k in zip(clock, ms, strict=True)],
        "python": [f"2026-03-14 09:{c},{k % 1000:03d} - INFO -" for c, k in zip(clock, ms, strict=True)],
    }
    name = sorted(stamps)[int(rng.integers(len(stamps)))]
    body = [f"{s} pos={1e3 * x:.4f} mm vel={1e3 * v:.4f} mm/s" for s, x, v in zip(stamps[name], m.x, m.v, strict=True)]
    return lines(folder / f"{name}.log", *body), {"t": 1e-3 * ms, "x": m.x, "v": m.v}


def serial_days(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Dates as a spreadsheet keeps them: days since 1900."""
    body = [f"{46095.38 + t / 86400.0:.12f};{1e3 * x:.6f}".replace(".", ",") for t, x in zip(m.t, m.x, strict=True)]
    return lines(folder / "messung.csv", "Datum/Uhrzeit;Weg (mm)", *body), {"t": m.t, "x": m.x}


def written_in_japan(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """In Shift JIS, with wide brackets around units that are words."""
    path = folder / "keisoku.csv"
    text = "\n".join(["時間（秒）,変位（ミリメートル）", *rows(",", m.t, 1e3 * m.x)])
    path.write_bytes(text.encode("shift-jis"))
    return path, {"t": m.t, "x": m.x}


def written_by_r(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """write.table: names of rows below no name."""
    body = [f'"{i}" {row}' for i, row in enumerate(rows(" ", m.t, 1e3 * m.x), 1)]
    return lines(folder / "table.txt", '"t" "x_mm"', *body), {"t": m.t, "x": m.x}


def two_levels(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """A table of pandas with names in two levels."""
    body = [f"{i},{row}" for i, row in enumerate(rows(",", m.t, 1e3 * m.x))]
    return lines(folder / "multi.csv", "sensor,laser,laser", "quantity,t_s,x_mm", *body), {"t": m.t, "x": m.x}


def dated_records(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    stamps = np.datetime64("2026-03-14T09:12:07") + np.round(1e6 * m.t).astype("timedelta64[us]")
    body = [json.dumps({"ts": f"{t}Z", "angle_deg": float(x)}) for t, x in zip(stamps, np.degrees(m.x), strict=True)]
    return lines(folder / "mqtt.jsonl", *body), {"t": m.t, "x": m.x}


def sensors_numbers(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Sensors whose names hold numbers, one of each kind, in units a spreadsheet's user types."""
    head = "Zeit  1 - Standardrate [ s ]\tWegsensor WA/20 [mm ]\tACC3 (m/s2)"
    return lines(folder / "weg.txt", head, *rows("\t", m.t, 1e3 * m.x, m.a, comma=True)), {"t": m.t, "x": m.x, "a": m.a}


def by_powers(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    head = "t / s,x / mm,v / mm·s⁻¹,a / m·s⁻²"
    return lines(folder / "si.csv", head, *rows(",", m.t, 1e3 * m.x, 1e3 * m.v, m.a)), {
        "t": m.t,
        "x": m.x,
        "v": m.v,
        "a": m.a,
    }


def unit_for_a_name(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    v = 20.0 * np.exp(-m.t / m.t[-1])
    return lines(folder / "bike.csv", "sec;km/h", *rows(";", m.t, v, comma=True)), {"t": m.t, "v": v / 3.6}


def gyroscope_bare(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Three axes of no unit: too fast for rad/s."""
    turned = 200.0 * m.v / np.abs(m.v).max()
    still = [0.05 * rng.standard_normal(m.t.size) for _ in "xz"]
    body = [f"{1e3 * t:.0f},{row}" for t, row in zip(m.t, rows(",", still[0], turned, still[1]), strict=True)]
    return lines(folder / "imu.csv", "timestamp,gx,gy,gz", *body), {"t": m.t, "v": np.radians(turned)}


def asked_and_measured(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """What was asked for stands before what was measured, in the words of three languages."""
    asked, x, u = [
        ("Sollposition", "Istposition", "Istkraft"),
        ("Consigne position", "Position mesurée", "Effort"),
        ("目标位置", "实际位置", "力"),
    ][int(rng.integers(3))]
    head = f"Time [ms];{asked} [mm];{x} [mm];{u} [N]"
    body = rows(";", 1e3 * m.t, 1.1e3 * m.x, 1e3 * m.x, m.a, comma=True)
    return lines(folder / "achse.csv", head, *body), {"t": m.t, "x": m.x, "u": m.a}


def yokogawa(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    head = [
        '"Header Size","16"', '"Model Name","DL850E"', '"Comment",""', '"BlockNumber","1"', '"TraceName ","CH1  "',
        f'"BlockSize ","{m.t.size}"', '"VUnit     ","mm"', f'"SampleRate","{1.0 / m.t[1]:g}"', '"HUnit     ","s"',
        '"Date      ","2026/03/14"', '"Time      ","09:12:07.250000"', "", "",
    ]  # fmt: skip
    return lines(folder / "dl850.csv", *head, *(f",{1e3 * x:.5E}" for x in m.x)), {"t": m.t, "x": m.x}


def graphtec(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """A clock of whole seconds, beside one of ms that begins again with each."""
    head = [
        "Vendor,GRAPHTEC Corporation", "Model,GL980", f"Sampling interval,{1e3 * m.t[1]:g}ms", "AMP settings",
        "CH,Signal name,Input,Range", "CH1,Laser,DC,1V", "Data", "Number,Date&Time,ms,CH1,A12,", "NO.,Time,ms,mm,A12,",
    ]  # fmt: skip
    ms = np.round(1e3 * m.t).astype(int)
    clock = [f"2026/3/14 09:{12 + k // 60000:02d}:{k // 1000 % 60:02d},{k % 1000}" for k in ms]
    body = [f"{i},{c},{1e3 * x:+.5f},HHHH," for i, (c, x) in enumerate(zip(clock, m.x, strict=True), 1)]
    return lines(folder / "gl980.csv", *head, *body), {"t": m.t, "x": m.x}


def stopwatch(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Minutes and seconds; the card's empty blocks stand behind the rows."""
    body = [f"{int(t // 60):02d}:{t % 60:06.3f},{1e3 * x:.5f}" for t, x in zip(m.t, m.x, strict=True)]
    path = lines(folder / "card.csv", "Time,Position (mm)", *body)
    path.write_bytes(path.read_bytes() + bytes(512))
    return path, {"t": m.t, "x": m.x}


def quoted_commas(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Decimal commas within quotes, commas between."""
    body = [f'"{t:.4f}","{1e3 * x:.4f}"'.replace(".", ",") for t, x in zip(m.t, m.x, strict=True)]
    return lines(folder / "export.csv", '"Zeit [s]","Weg [mm]"', *body), {"t": m.t, "x": m.x}


def written_in_russia(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    path = folder / "opyt.csv"
    head = "Время, с;Перемещение, мм;Скорость, мм/с"
    path.write_bytes("\n".join([head, *rows(";", m.t, 1e3 * m.x, 1e3 * m.v, comma=True)]).encode("cp1251"))
    return path, {"t": m.t, "x": m.x, "v": m.v}


def rockwell(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Settings in lines of other widths, and the ms of a time of day behind a semicolon."""
    head = [
        'Controller Name:,"Line3"', "Trend Name:,Axis", "Trend Tags:,1", f"Sample Period:,{1e3 * m.t[1]:g},ms",
        'Description:,""', "Start Time:,3/14/2026;15:04:05", "Header:,Date,Time,Axis01.ActualPosition",
    ]  # fmt: skip
    ms = np.round(1e3 * m.t).astype(int)
    body = [f"Data,3/14/2026,15:04:{5 + k // 1000:02d};{k % 1000:03d},{x:.6f}" for k, x in zip(ms, m.x, strict=True)]
    return lines(folder / "trend.csv", *head, *body, end="\r\n"), {"t": m.t, "x": m.x}


def fit_csv(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Messages of several kinds; each line names its fields, in no fixed order, and counts stamps from 1989."""
    names = ",".join(f"Field {i},Value {i},Units {i}" for i in (1, 2, 3))
    head = [
        f"Type,Local Number,Message,{names},",
        "Definition,0,file_id,serial_number,1,,time_created,1,,type,1,,",
        'Data,0,file_id,serial_number,"3993",,time_created,"1049300000",,type,"4",,',
        "Definition,1,record,timestamp,1,,distance,1,,enhanced_speed,1,,",
    ]
    t, speed = np.arange(m.t.size, dtype=float), np.linspace(12.0, 0.2, m.t.size)
    gone = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))))
    told = [(f'timestamp,"{1049300000 + k}",s', f'distance,"{x:.3f}",m', f'enhanced_speed,"{v:.4f}",m/s')
            for k, (x, v) in enumerate(zip(gone, speed, strict=True))]  # fmt: skip
    body = [f"Data,1,record,{','.join(one if k % 5 else one[::-1])}," for k, one in enumerate(told)]
    event = 'Data,2,event,timestamp,"1049300009",s,event,"0",,,,,'
    return lines(folder / "ride.csv", *head, *body[:9], event, *body[9:]), {"t": t, "x": gone, "v": speed}


def dashboard(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """A unit in each cell."""
    body = [
        f"2026-03-14 15:04:{5 + int(t):02d}.{round(1e3 * (t % 1)):03d},{1e3 * x:.4f} mm"
        for t, x in zip(np.round(m.t, 3), m.x, strict=True)
    ]
    return lines(folder / "panel.csv", '"Time","Piston travel"', *body), {"t": m.t, "x": m.x}


def spans(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Times since the start, as pandas writes them."""
    body = [f"0 days 00:00:{t:09.6f},{x:.6f}" for t, x in zip(m.t, m.x, strict=True)]
    return lines(folder / "frame.csv", ",position_m", *body), {"t": m.t, "x": m.x}


def phone_records(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Records of all sensors in one list, their numbers as text."""
    axes, start = _axes(m.v, rng), 1700000000123456789
    found: list[dict[str, str]] = [{"version": "1", "platform": "android"}]
    for k, t in enumerate(m.t):
        stamp = {"time": str(start + round(1e9 * t)), "seconds_elapsed": f"{t + 0.2:.7f}"}
        found.append({"sensor": "Accelerometer", **stamp, "z": "9.81", "y": f"{m.a[k]:.7f}", "x": "0.01"})
        of_axes = {name: f"{axes[i][k]:.9f}" for i, name in enumerate("xyz")}
        found.append({"sensor": "Gyroscope", **stamp, **of_axes})
    path = folder / "pendulum.json"
    path.write_text(json.dumps(found))
    return path, {"t": m.t, "v": axes[1]}


def modelica(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """A component's position is called s, and a derivative der(mass.v)."""
    head = '"time","mass.s","mass.v","der(mass.v)"'
    return lines(folder / "exported.csv", head, *rows(",", m.t, m.x, m.v, m.a)), {
        "t": m.t, "x": m.x, "v": m.v, "a": m.a,
    }  # fmt: skip


def plot_juggler(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Rows of another topic lie between those of a joint."""
    head = "__time,/joint_states/elbow/position,/joint_states/elbow/velocity,/tf/age"
    body = [
        f"{1.7e9 + t:.6f},{x:.6f},{v:.6f},\n{1.7e9 + t + 0.001:.6f},,,{0.01 + 0.002 * (k % 7)}"
        for k, (t, x, v) in enumerate(zip(m.t, m.x, m.v, strict=True))
    ]
    return lines(folder / "bag.csv", head, *body), {"t": m.t, "x": m.x, "v": m.v}


def motec(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Units of pressures among those of the motion, between blank lines."""
    head = [
        '"Format","MoTeC CSV File",,,"Workbook","Coast"', '"Venue","Track",,,"Worksheet","1"',
        f'"Sample Rate","{1.0 / m.t[1]:.3f}","Hz"', "", '"Time","Damper Pos FL","Brake Pres F"', '"s","mm","bar"', "",
    ]  # fmt: skip
    body = [f'"{t:.4f}","{1e3 * x:.4f}","0.00"' for t, x in zip(m.t, m.x, strict=True)]
    return lines(folder / "motec.csv", *head, *body), {"t": m.t, "x": m.x}


def racechrono(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Lines of names, of units and of the sources."""
    head = [
        "This file is created using RaceChrono v7.0 (http://racechrono.com/).", "Format,3", 'Session title,"Coast"', "",
        "timestamp,lap_number,altitude,satellites,speed", "unix time,,m,sats,km/h", ",,100: gps,100: gps,100: gps",
    ]  # fmt: skip
    t, v = 0.1 * np.arange(m.t.size), np.linspace(29.0, 1.0, m.t.size)
    body = [f"{1.71e9 + k:.3f},,210.1,14,{3.6 * y:.5f}" for k, y in zip(t, v, strict=True)]
    return lines(folder / "session.csv", *head, *body), {"t": t, "v": v}


def data_inspector(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    head = ["time,Position,Velocity", ",Unit: mm,Unit: mm/s", ",Interp: linear,Interp: linear"]
    return lines(folder / "sdi.csv", *head, *rows(",", m.t, 1e3 * m.x, 1e3 * m.v)), {"t": m.t, "x": m.x, "v": m.v}


def trackmate(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Three lines of names and one of units, a word that is none among them."""
    head = [
        "LABEL,ID,QUALITY,POSITION_X,POSITION_Y,POSITION_T,FRAME", "Label,Spot ID,Quality,X,Y,T,Frame",
        "Label,Spot ID,Quality,X,Y,T,Frame", ",,(quality),(mm),(mm),(sec),",
    ]  # fmt: skip
    body = [
        f"ID{900 + k},{900 + k},12.3,{1e3 * x:.4f},{120.0 + 0.1 * rng.standard_normal():.3f},{t:.5f},{k}"
        for k, (t, x) in enumerate(zip(m.t, m.x, strict=True))
    ]
    return lines(folder / "spots.csv", *head, *body), {"t": m.t, "x": m.x}


def one_value_a_row(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Signals one below another, each under its name."""
    body = []
    for k, (t, x) in enumerate(zip(m.t, m.x, strict=True)):
        body += [f"{1.7e9 + t:.6f},temperature_C,{21.0 + 0.01 * k:.2f}"] if k % 3 == 0 else []
        body += [f"{1.7e9 + t:.6f},position_mm,{1e3 * x:.5f}"]
    return lines(folder / "historian.csv", "timestamp,signal,value", *body), {"t": m.t, "x": m.x}


def influx(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    head = [
        "#group,false,false,false,false,true,true", "#datatype,string,long,dateTime:RFC3339,double,string,string",
        "#default,_result,,,,,", ",result,table,_time,_value,_field,_measurement",
    ]  # fmt: skip
    rpm = np.linspace(900.0, 20.0, m.t.size)
    body = [
        f",,0,2026-03-14T10:00:{int(t):02d}.{round(1e3 * (t % 1)):03d}Z,{y:.4f},rpm,spindle"
        for t, y in zip(np.round(m.t, 3), rpm, strict=True)
    ]
    return lines(folder / "query.csv", *head, *body), {"t": m.t, "v": rpm * np.pi / 30.0}


def streams(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Lists of one length, each in an object of its own."""
    named = {"time": m.t, "velocity_smooth": m.v, "cadence": 0.0 * m.t}
    path = folder / "activity.json"
    path.write_text(json.dumps({name: {"data": y.tolist(), "resolution": "high"} for name, y in named.items()}))
    return path, {"t": m.t, "v": m.v}


def unit_beside_value(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    told = [
        json.dumps({"ts": float(t), "payload": {"pos": {"value": 1e3 * float(x), "unit": "mm"}}})
        for t, x in zip(m.t, m.x, strict=True)
    ]
    return lines(folder / "broker.jsonl", *told), {"t": m.t, "x": m.x}


def western_micro(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """A micro sign in the Western coding, which others take for a letter; the day in a column of its own."""
    told = np.round(m.t, 3)
    body = [
        f"14.03.2026;15:04:{5 + int(t):02d},{round(1e3 * (t % 1)):03d};{1e6 * x:.1f}".replace(".", ",").replace(
            "14,03,2026", "14.03.2026"
        )
        for t, x in zip(told, m.x, strict=True)
    ]
    path = folder / "lvdt.txt"
    path.write_bytes("\r\n".join(["Datum;Uhrzeit;Weg [µm]", *body]).encode("cp1252"))
    return path, {"t": m.t, "x": m.x}


def opensim_markers(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    rate = f"{1.0 / m.t[1]:.2f}"
    head = ["PathFileType\t4\t(X/Y/Z)\ttrial.trc", "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate"]
    head += [f"{rate}\t{rate}\t{m.t.size}\t1\tmm\t{rate}", "Frame#\tTime\tcart\t\t", "\t\tX1\tY1\tZ1", ""]
    still = [500.0 + 0.01 * rng.standard_normal(m.t.size) for _ in "yz"]
    body = [f"{i}\t{row}" for i, row in enumerate(rows("\t", m.t, 1e3 * m.x, *still), 1)]
    return lines(folder / "trial.trc", *head, *body), {"t": m.t, "x": m.x}


def twincat_with_units(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    head = [
        "Name;Scope Project", "File;YT Scope.tcscopex", "", "Name;Axis 1.ActPos;Name;Axis 1.ActVelo",
        "Data-Type;REAL64;Data-Type;REAL64", "SampleTime[ms];5;SampleTime[ms];5", "Unit;mm;Unit;mm/s", "",
    ]  # fmt: skip
    body = rows(";", 1e3 * m.t, 1e3 * m.x, 1e3 * m.t, 1e3 * m.v, comma=True)
    return lines(folder / "scope.csv", *head, *body), {"t": m.t, "x": m.x, "v": m.v}


def settings_of_a_scope(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Among the settings a V that is no velocity, and lines without anything in them."""
    head = ["Model,MSO54", "Waveform Type,ANALOG", "Horizontal Units,s", "Record Length,1000", "Probe Attenuation,10"]
    head += ["Vertical Units,mm", "Vertical Position,-0.98", ",", ",", "Label,", "TIME,CH1"]
    return lines(folder / "tek0001.csv", *head, *rows(",", m.t - 3.0, 1e3 * m.x)), {"t": m.t, "x": m.x}


def g_of_a_phone(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Physics Toolbox's names say g; its own gravity may be off."""
    still = [0.9 + 0.001 * rng.standard_normal(m.t.size) for _ in "yz"]
    a = 3.0 * m.a / np.abs(m.a).max()
    return lines(folder / "g.csv", "time,gFx,gFy,gFz", *rows(",", m.t, a / 9.80665, *still)), {"t": m.t, "a": a}


def unit_in_a_column(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    body = [f"2026/03/14,10:00:{t:06.3f},{1e3 * x:.4f},mm" for t, x in zip(np.round(m.t, 3), m.x, strict=True)]
    return lines(folder / "gauge.csv", "Date,Time,Value,Unit", *body), {"t": m.t, "x": m.x}


def wrapped_names(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Names that a spreadsheet wraps, in quotes over two lines."""
    body = rows(";", 1e3 * m.t, 1e3 * m.x, comma=True)
    return lines(folder / "rig.csv", '"Zeit\n[ms]";"Weg\nin mm"', *body), {"t": m.t, "x": m.x}


def message_of_a_simulator(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """ROS's rostopic echo -p: a speed is called x as the position is."""
    names = [f"field.{one}" for one in ("pose.position.x", "pose.position.y", "twist.linear.x", "twist.angular.z")]
    body = [
        f"{1_700_000_000_000_000_000 + round(1e9 * t)},{row}"
        for t, row in zip(m.t, rows(",", m.x, 0.0 * m.t, m.v, 0.0 * m.t), strict=True)
    ]
    return lines(folder / "echo.csv", ",".join(["%time", *names]), *body), {"t": m.t, "x": m.x, "v": m.v}


def rates_of_an_autopilot(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    still = [0.001 * rng.standard_normal(m.t.size) for _ in "yz"]
    body = [f"{round(1e6 * t) + 100_000},{row}" for t, row in zip(m.t, rows(",", m.v, *still), strict=True)]
    return lines(folder / "px4.csv", "timestamp,rollspeed,pitchspeed,yawspeed", *body), {"t": m.t, "v": m.v}


def control_desk(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """dSPACE's: names and units stand beside the data."""
    signals = [("Model Root/Slider/pos [mm]", "mm", 1e3 * m.x), ("Model Root/Slider/acc", "m/s^2", m.a)]
    kind = [("Name", "O"), ("Data", "O"), ("Unit", "O"), ("XIndex", "O")]
    y, x = np.zeros((1, 2), kind), np.zeros((1, 1), kind)
    for i, (name, unit, values) in enumerate(signals):
        y[0, i] = name.replace(" [mm]", ""), values[None, :], unit, 1
    x[0, 0] = "time", m.t[None, :], "s", 1
    scipy.io.savemat(folder / "rec1.mat", {"rec1": {"X": x, "Y": y, "Description": "slider"}})
    return folder / "rec1.mat", {"t": m.t, "x": m.x, "a": m.a}


def universal_file(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Data sets 58 of modal analysis, in one and in two precisions, and one that is no time response."""
    step = m.t[1]

    def data_set(kind: int, unit: str, function: int, values: np.ndarray, wide: bool) -> list[str]:
        each, shape = (4, "%20.12e") if wide else (6, "%13.5e")
        head = ["    -1", "    58", "none", "NONE", "14-Mar-26 10:00:00", "NONE", "NONE"]
        head += [f"{function:5}{1:10}{1:5}{0:10} {'NONE':10}{7:10}{3:4} {'NONE':10}{0:10}{0:4}"]
        head += [f"{4 if wide else 2:10}{values.size:10}{1:10}{0.0:13.5e}{step:13.5e}{0.0:13.5e}"]
        axes = [(17, "Time", "s"), (kind, "Response", unit), (0, "NONE", "NONE"), (0, "NONE", "NONE")]
        head += [f"{i:10}{0:5}{0:5}{0:5} {said:20} {of:20}" for i, said, of in axes]
        rows = [values[i : i + each] for i in range(0, values.size, each)]
        return [*head, *("".join(shape % v for v in row) for row in rows), "    -1"]

    body = [*data_set(8, "mm", 1, 1e3 * m.x, True), *data_set(12, "m/s^2", 1, m.a, False)]
    body += data_set(12, "m/s^2", 4, m.a, False)
    return lines(folder / "modal.uff", *body), {"t": m.t, "x": m.x, "a": m.a}


def quoted_semicolons(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Every cell in quotes, between semicolons and with a decimal comma."""
    body = [f'"{row}"' for row in rows('";"', m.t, 1e3 * m.x, comma=True)]
    return lines(folder / "export.csv", '"Zeit [s]";"Weg [mm]"', *body, end="\r\n"), {"t": m.t, "x": m.x}


def a_log_with_units(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    body = [f"[{t:10.4f}] INFO pos: {1e3 * x:.4f} mm" for t, x in zip(m.t, m.x, strict=True)]
    return lines(folder / "serial.log", *body), {"t": m.t, "x": m.x}


def objects_in_a_log(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """Lines of JSON in a file that is not called so."""
    body = [json.dumps({"t": float(t), "pos_mm": 1e3 * float(x)}) for t, x in zip(m.t, m.x, strict=True)]
    return lines(folder / "telemetry.log", *body), {"t": m.t, "x": m.x}


def number_of_a_device(folder: Path, m: Motion, rng: np.random.Generator) -> tuple[Path, Wanted]:
    """A column called unit that is none of a unit."""
    body = [f"{row},1" for row in rows(",", m.t, m.x)]
    return lines(folder / "fleet.csv", "time,value,unit", *body), {"t": m.t, "x": m.x}


WRITERS: dict[str, Writer] = {
    one.__name__: one
    for one in (
        phyphox_gyroscope, phyphox_german, vernier_runs, graphical_analysis, logger_pro_latest, logger_pro_text,
        capstone, arduino_banner, arduino_monitor, arduino_plotter, labview, labview_by_step, cassy, tracker,
        moteus, sysid, vbox, vbox_table,
        odrive, picoscope, mujoco, microcontroller, rig, languages, water_pendulum, phyphox_zip,
        phyphox_excel, excel_by_hand, labx, wpilog, tdms, matlab_rows, matlab_trials, simulink, hdf5, json_lines,
        json_entries, runs_below, sensor_logger, catman, polytec, feels_its_weight, times_of_day,
        printed, stamps_in_two, whole_seconds_and_the_rest, with_a_summary,
        physics_toolbox, motive, qualisys, vicon, xsens, timetable, tektronix,
        imu_in_g, french, tachometer, logger_pro, graphical_analysis_archive, thousands_parted, motive_in_mm, twincat,
        odrive_gui, mso, boards_log, serial_days, written_in_japan, written_by_r, two_levels, dated_records,
        sensors_numbers, by_powers, unit_for_a_name, gyroscope_bare, asked_and_measured, yokogawa, graphtec, stopwatch,
        quoted_commas, written_in_russia, rockwell, fit_csv, dashboard, spans, phone_records, modelica, plot_juggler,
        motec, racechrono, data_inspector, trackmate, one_value_a_row, influx, streams, unit_beside_value,
        western_micro, opensim_markers, twincat_with_units, settings_of_a_scope, g_of_a_phone, unit_in_a_column,
        wrapped_names, message_of_a_simulator, rates_of_an_autopilot, control_desk, universal_file,
        quoted_semicolons, a_log_with_units, objects_in_a_log, number_of_a_device,
    )
}  # fmt: skip
