"""Parquet."""

from harness.io.binary import ParquetTable
from harness.io.reader import Reader

READER = Reader(name="Parquet", suffixes=(".parquet", ".pq"), open=ParquetTable)
