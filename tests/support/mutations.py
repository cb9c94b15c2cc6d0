"""Changes of valid files at the places their readers look at: headers, lengths, counts."""

import re
import struct

from hypothesis import strategies as st

NUMBERS = (
    0, 1, 2, 7, 0x7F, 0x80, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 1 << 40, (1 << 63) - 1,
    (1 << 64) - 1,
)  # fmt: skip
"""What lengths and counts break at."""
TEXTS = (
    *(b"", b"\r", b"\n", b",", b";", b"\t", b'"', b"[", b"]", b"nan", b"inf", b"-1e308", b"1e-320", b"1_0", b"\x00"),
    *(b"\xff", b"\x1b[2J", b"#", b"%", b" " * 70_000, b"9" * 400),
)
"""What tables break at."""

_MARKS = rb"PK\x01\x02|PK\x03\x04|PK\x05\x06|NUMPY|MATLAB|\x89HDF|TREE|HEAP|SNOD|OHDR|PAR1|RRF|[\x0e\x0f]\x00\x00\x00"
Change = tuple[str, int, int, bytes]


def spots(data: bytes) -> list[int]:
    """Places where a format keeps structure: zip, NumPy, MATLAB, HDF5, Parquet and rrd headers, and both ends."""
    found = [match.start() for match in re.finditer(_MARKS, data)]
    near = [place + offset for place in found for offset in range(0, 48, 2)]
    ends = [*range(0, min(len(data), 256), 2), *range(max(0, len(data) - 600), len(data), 3)]
    return sorted({place for place in (*near, *ends) if place < len(data)})


def applied(data: bytes, changes: list[Change]) -> bytes:
    """The changes in turn, each at its place."""
    for kind, place, size, text in changes:
        at = min(place, len(data))
        match kind:
            case "number":
                data = data[:at] + text + data[at + len(text) :]
            case "insert":
                data = data[:at] + text + data[at:]
            case "remove":
                data = data[:at] + data[at + size :]
            case "repeat":
                data = data[: at + size] + data[at:]
            case "cut":
                data = data[:at]
    return data


def changed(data: bytes, places: list[int], texts: tuple[bytes, ...] = ()) -> st.SearchStrategy[bytes]:
    """``data`` after one to four changes; texts : what is inserted besides numbers."""
    place = st.sampled_from(places) | st.integers(0, len(data))
    width = st.sampled_from(["<B", "<H", "<I", "<Q", ">I"])
    number = st.builds(
        lambda form, value: struct.pack(form, value & ((1 << 8 * struct.calcsize(form)) - 1)),
        width,
        st.sampled_from(NUMBERS),
    )
    size = st.sampled_from([1, 2, 4, 8, 64, 512, 4096])
    kinds = [
        st.tuples(st.just("number"), place, st.just(0), number),
        st.tuples(st.sampled_from(["remove", "repeat", "cut"]), place, size, st.just(b"")),
    ]
    if texts:
        kinds.append(st.tuples(st.just("insert"), place, st.just(0), st.sampled_from(texts)))
    return st.lists(st.one_of(kinds), min_size=1, max_size=4).map(lambda changes: applied(data, changes))
