"""A stand-in for the sealed diagnosis: answers at once that nothing is left out; "slow" as argument takes its time."""

import json
import sys
import time

BETTER = {"baseline_rmse": {"x": 1.0, "a": 1.0}, "refined_rmse": {"x": 1.0, "a": 1.0}}
FORCED = {"name": "stribeck", **BETTER}
SAID = {"verdict": "adequate", "mechanisms": [], "holdout": {**BETTER, "forced": FORCED}, "engines": {}}


def main() -> None:
    while line := sys.stdin.buffer.readline():
        head = json.loads(line)
        recording = sys.stdin.buffer.read(head["bytes"])
        time.sleep(0.3 if "slow" in sys.argv else 0.0)
        with_x = b"x" in recording.split(b"\n")[0]
        more = {} if head["who"] == "harness" else {"applies": with_x, "why": "", "rmse": {"x": 2.0}}
        said = json.dumps({**SAID, **more}, sort_keys=True, separators=(",", ":")).encode()
        sys.stdout.buffer.write(b"%d\n" % len(said) + said)
        sys.stdout.buffer.flush()


if __name__ == "__main__":
    main()
