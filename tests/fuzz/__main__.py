"""``python tests/fuzz``: the guided search, with what it imports from beside."""

import sys
from pathlib import Path


def main() -> int:
    """Find the helpers of tests as pytest does, and search."""
    tests = Path(__file__).resolve().parents[1]
    sys.path[:0] = [str(tests.parent), str(tests / "support")]
    from fuzz_guided import main as search

    return search()


if __name__ == "__main__":
    sys.exit(main())
