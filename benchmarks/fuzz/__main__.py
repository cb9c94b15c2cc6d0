"""``PYTHONPATH=.:tests/support python -m benchmarks.fuzz --seconds 600``: the guided search."""

import sys

from benchmarks.fuzz.search import main

if __name__ == "__main__":
    sys.exit(main())
