"""Text tables."""

from harness.io.reader import Reader
from harness.io.text import TextTable

READER = Reader(
    name="text tables, also gzipped",
    suffixes=(".csv", ".txt", ".dat", ".tsv", ".asc", ".tab"),
    open=TextTable,
    text=True,
)
