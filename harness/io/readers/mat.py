"""MATLAB, version 4 to 7.3."""

from harness.io.binary import open_mat
from harness.io.reader import Reader

READER = Reader(name="MATLAB", suffixes=(".mat",), open=open_mat)
