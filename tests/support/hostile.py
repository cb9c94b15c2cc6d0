"""Files that somebody wrote to do harm, or that came to harm, by name; each made in a folder."""

import gzip
import io
import json
import zipfile
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import scipy.io

N = 400
T = np.arange(N) / 200.0
X = np.exp(-0.5 * T) * np.cos(10.0 * T)
ROWS = ("t,x", *(f"{t:.6f},{x:.6f}" for t, x in zip(T, X, strict=True)))
BASE: dict[str, object] = {"m": 1, "c": 1, "k": 100, "f_k": 3}
MODEL: dict[str, object] = {"schema": "harness.model/1", "base": BASE, "release": {"x0": 1, "v0": 0}}
Make = Callable[[Path], object]


def table(line: str | None = None, header: str = "t,x", scale: str = "") -> Make:
    """A CSV with one line, its header or the ends of its numbers changed; ``scale`` is "T e300" or "X e300"."""

    def make(path: Path) -> None:
        rows = [header, *ROWS[1:]]
        if line is not None:
            rows[20] = line
        if scale:
            column, power = scale.split()
            cells = [row.split(",") for row in rows[1:]]
            rows[1:] = [f"{t}{power if column == 'T' else ''},{x}{power if column == 'X' else ''}" for t, x in cells]
        path.write_bytes("\n".join(rows).encode() + b"\n")

    return make


def npy(array: np.ndarray, shape: str = "") -> bytes:
    """A .npy file; ``shape`` in place of the array's own in its header."""
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue().replace(b"(400,), }" + b" " * 20, f"({shape},), }}".ljust(29).encode() if shape else b"")


def archive(
    compression: int = zipfile.ZIP_STORED, shape: str = "400", change: Callable[[bytearray], None] | None = None
) -> Make:
    """An .npz with something wrong in its bytes."""

    def make(path: Path) -> None:
        with zipfile.ZipFile(path, "w", compression) as file:
            file.writestr("t.npy", npy(T, shape))
            file.writestr("x.npy", npy(X, "400"))
        data = bytearray(path.read_bytes())
        if change is not None:
            change(data)
        path.write_bytes(data)

    return make


def flipped(data: bytearray) -> None:
    """Bits of the first member's content turned."""
    for place in range(60, 300, 7):
        data[place] ^= 0x55


def everywhere(local: int, central: int, value: int) -> Callable[[bytearray], None]:
    """One byte of every header of a zip file, in both of its places."""

    def change(data: bytearray) -> None:
        for mark, offset in ((b"PK\x03\x04", local), (b"PK\x01\x02", central)):
            place = data.find(mark)
            while place >= 0:
                data[place + offset] = value
                place = data.find(mark, place + 4)

    return change


def npz_bomb(path: Path) -> None:
    """Kilobytes that say they are gigabytes, and are."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as file:
        for name in ("t", "x"):
            with file.open(f"{name}.npy", "w", force_zip64=True) as member:
                about = {"descr": "<f8", "fortran_order": False, "shape": (300_000_000,)}
                np.lib.format.write_array_header_1_0(member, about)
                member.write(bytes(1 << 20))


def gzip_bomb(path: Path) -> None:
    """Members of a gzip stream may follow each other: the same megabytes a hundred times."""
    piece = gzip.compress(b"0,0\n" * (1 << 22), compresslevel=1)
    path.write_bytes(gzip.compress(b"t,x\n") + piece * 80)


def sparse(path: Path) -> None:
    """Five gigabytes, of which the disk holds nothing."""
    with path.open("wb") as file:
        file.truncate(5_000_000_000)


def elsewhere(path: Path) -> None:
    """A MATLAB 7.3 file whose x is another file of this machine."""
    X.tofile(path.with_name("secret.bin"))
    with h5py.File(path, "w", userblock_size=512) as file:
        file["t"] = T
        file.create_dataset("x", (N,), "f8", external=[(str(path.with_name("secret.bin")), 0, 8 * N)])
    with path.open("r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file")


def virtual(path: Path) -> None:
    """The same by HDF5's other way."""
    with h5py.File(path.with_name("other.h5"), "w") as other:
        other["x"] = X
    layout = h5py.VirtualLayout((N,), "f8")
    layout[:] = h5py.VirtualSource(str(path.with_name("other.h5")), "x", (N,))
    with h5py.File(path, "w") as file:
        file["t"] = T
        file.create_virtual_dataset("x", layout)


def pickled(path: Path) -> None:
    np.savez(path, t=T, x=np.array([print] * N, dtype=object))


def parquet_of_escapes(path: Path) -> None:
    """Neither of which rises as a time does."""
    pq.write_table(pa.table({"t\x1b[31m\nq": X, "x": X}), path)


def parquet_of_bytes(path: Path) -> None:
    """The name of a column is no text."""
    pq.write_table(pa.table({"t": T, "xcol": X}), path, store_schema=False)
    path.write_bytes(path.read_bytes().replace(b"xcol", b"\xffcol"))


def cut(make: Make, share: float) -> Make:
    """The first part of another file."""

    def shortened(path: Path) -> None:
        make(path)
        data = path.read_bytes()
        path.write_bytes(data[: int(share * len(data))])

    return shortened


def mat(path: Path) -> None:
    scipy.io.savemat(path, {"t": T, "x": X})


def mat_packed(path: Path) -> None:
    scipy.io.savemat(path, {"t": T, "x": X}, do_compression=True)


def mat73(path: Path) -> None:
    with h5py.File(path, "w", userblock_size=512) as file:
        file["t"], file["x"] = T, X
    with path.open("r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file")


def parquet(path: Path) -> None:
    pq.write_table(pa.table({"t": T, "x": X}), path)


def model(**base: object) -> Make:
    """A model file with something else among its base parameters."""
    return lambda path: path.write_text(json.dumps(MODEL | {"base": BASE | base}))


def text(content: str) -> Make:
    return lambda path: path.write_text(content)


HOSTILE: dict[str, tuple[Make, str]] = {
    "return.csv": (table("0.095,\r0.3\r0.4\r0.5"), "): 1 cells; expected 2, as in the first row"),
    "cell.csv": (table("0.095," + "1" * 140_000 + "x"), "cells of at most 131072 characters"),
    "line.csv": (table("0.095," + "1," * 600_000), "lines of at most 1048576"),
    "escape.csv": (table("0.095,\x1b[31mred\x07"), r"column x: the text '\x1b[31mred\x07'; expected a number"),
    "header.csv": (
        table(header="t,x" + " " * 50_000 + "y [kg]"),
        "...; expected columns named t and one or more of x, v, a",
    ),
    "escaped.csv": (table(header="t,\x1b[31mx [kg]"), r"the columns t, \x1b[31mx; "),
    "times.csv": (table(scale="T e300"), "at most 9e+09 in size"),
    "large.csv": (table(scale="X e300"), "at most 1e+20 in size"),
    "small.csv": (table(scale="X e-300"), "column x: a range of 1.86e-300; expected one of 1e-20 or more"),
    "quick.csv": (table(scale="T e-300"), "column t: samples 5e-303 s apart; expected 1e-15 s or more"),
    "bomb.csv.gz": (gzip_bomb, "more than 1073741824 bytes, unpacked; expected at most 1073741824"),
    "damaged.csv.gz": (
        cut(lambda path: path.write_bytes(gzip.compress("\n".join(ROWS).encode())), 0.5),
        "unreadable (",
    ),
    "sparse.csv": (sparse, "5000000000 bytes; expected at most 1073741824"),
    "zlib.npz": (archive(zipfile.ZIP_DEFLATED, change=flipped), "not an .npz archive (Error -3 while decompressing"),
    "lzma.npz": (archive(zipfile.ZIP_LZMA, change=flipped), "not an .npz archive (Corrupt input data)"),
    "bz2.npz": (archive(zipfile.ZIP_BZIP2, change=flipped), "not an .npz archive (Invalid data stream)"),
    "encrypted.npz": (archive(change=everywhere(6, 8, 1)), "is encrypted, password required"),
    "method.npz": (archive(change=everywhere(8, 10, 99)), "That compression method is not supported"),
    "header.npz": (archive(shape="4" * 15), "takes more than 2048 MiB of memory to read"),
    "bomb.npz": (npz_bomb, "takes more than 2048 MiB of memory to read"),
    "pickled.npz": (pickled, "x: pickled Python objects, which could run a program; "),
    "elsewhere.mat": (elsewhere, "x: kept in another file; expected a data set kept in this file"),
    "virtual.mat": (virtual, "x: kept in another file; expected a data set kept in this file"),
    "cut.mat": (cut(mat, 0.7), "not a MATLAB file ("),
    "cut73.mat": (cut(mat73, 0.7), "not a MATLAB file ("),
    "cut.parquet": (cut(parquet, 0.7), "not a Parquet file ("),
    "escape.parquet": (parquet_of_escapes, r"the columns t\x1b[31m q, x. "),
    "bytes.parquet": (parquet_of_bytes, "not a Parquet file ('utf-8' codec can't decode"),
    "no.rrd": (text("RRF2 and nothing more"), "a whole .rrd written by this program"),
}
"""Recordings, each with a part of the line that refuses it."""

MODELS: dict[str, tuple[Make, str]] = {
    "deep.json": (text("[" * 100_000), "nested too deeply; expected JSON of harness.model/1"),
    "digits.json": (model(k=10**3000), "a number of 3001 digits; expected JSON of harness.model/1"),
    "integer.json": (model(k=10**400), "base.k: a number of more than 308 digits; expected a finite number"),
    "large.json": (model(k=1e300), "base.k: 1e+300; expected 0, or 1e-30 to 1e+30 in size"),
    "small.json": (model(m=1e-300), "base.m: 1e-300; expected 0, or 1e-30 to 1e+30 in size"),
    "quick.json": (model(k=1e30), "scenario: 3.18e+11 half-cycles in 0.001 s; expected at most 1000000"),
    "nan.json": (model(k=float("nan")), "NaN is not a number of JSON"),
    "text.json": (model(k="a" * 1_000_000), "..."),
    "bytes.json": (lambda path: path.write_bytes(b"\xff\xfe{"), "not text"),
}
"""Model files, likewise."""
