"""NumPy archives."""

from harness.io.binary import open_npz
from harness.io.reader import Reader

READER = Reader(name="NumPy", suffixes=(".npz",), open=open_npz)
