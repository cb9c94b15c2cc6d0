"""python -m benchmarks.robot_calibrate --draws N --seed S: the figures of friction from a whole arm's log."""

import argparse
import sys
import time
from collections.abc import Iterator, Sequence

import numpy as np

from benchmarks.robot_calibrate.draws import KINDS, NOISE, Draw, Found, draw
from harness.core.arrays import BoolArray

_COULOMB, _VISCOUS = 0.01, 0.05
"""Shares of the true value within which friction is asked for."""
_BINS = ((20.0, 50.0), (50.0, 200.0), (200.0, np.inf))


def main(argv: Sequence[str] | None = None) -> int:
    """Draw, and print; exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.robot_calibrate")
    parser.add_argument("--draws", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first draw")
    parser.add_argument("--only", choices=KINDS, action="append", help="arms of this kind; may repeat")
    parser.add_argument("--noise", type=float, default=NOISE, help="of the torque, a share of its rms")
    parser.add_argument("--aim", type=float, nargs=2, metavar=("LOW", "HIGH"), help="limits that effects are made for")
    parser.add_argument("--each", action="store_true", help="a line for every draw as it is done")
    told = parser.parse_args(argv)
    kinds = tuple(told.only or KINDS)
    draws, began = [], time.perf_counter()
    for number in range(told.first, told.first + told.draws):
        draws.append(draw(told.seed, number, kinds, told.noise, told.aim and tuple(told.aim)))
        if told.each:
            print(f"{number}: {_line(draws[-1])}", flush=True)
    spent = (time.perf_counter() - began) / max(told.draws * len(kinds), 1)
    print(f"{told.draws} draws from {told.first}, seed {told.seed}: {spent:.1f} s a log of 20 s, with its simulation")
    print("\n".join((*_clean_said(draws), *_effects_said(draws), *_errors_said(draws))))
    return 0


def _line(one: Draw) -> str:
    parts = []
    if one.clean:
        largest = np.max(np.abs(one.clean.errors / one.clean.claimed))
        parts.append(f"clean {list(one.clean.named)} z {largest:.1f} left out {one.clean.left_out:.1f}")
    for found in (one.effect, one.error):
        if found:
            word = "named" if found.named else "listed" if found.listed else "MISSED"
            parts.append(f"{found.put_in} {found.limit:.0f} {word} {list(found.besides)}")
    return "; ".join(parts)


def _clean_said(draws: Sequence[Draw]) -> Iterator[str]:
    clean = [one.clean for one in draws if one.clean]
    if not clean:
        return
    for i, (what, asked) in enumerate((("Coulomb", _COULOMB), ("viscous", _VISCOUS))):
        errors, claimed, bounds = (
            np.array([getattr(one, field)[:, i] for one in clean]) for field in ("errors", "claimed", "bounds")
        )
        sharp, within, covered = bounds < asked / 2.0, np.abs(errors) < asked, np.abs(errors) < 2.0 * claimed
        yield (
            f"{what}: within {asked:.0%} in {_of(within[sharp])} of joints whose bound is below half of it; two"
            f" standard errors cover {_of(covered)}, {_of(covered[~sharp])} where it is not; standard error"
            f" {np.median(claimed / bounds):.2f} of the bound in the median"
        )
    yield f"clean arms in which nothing is named: {_of(np.array([not one.named for one in clean]))}"
    left_out = np.quantile([one.left_out for one in clean], (0.5, 0.9, 0.98, 1.0))
    yield f"  evidence of the best that is not named, 50, 90, 98, 100 %: {', '.join(f'{x:.1f}' for x in left_out)}"


def _effects_said(draws: Sequence[Draw]) -> Iterator[str]:
    above = [one.effect for one in draws if one.effect and one.effect.limit > _BINS[0][0]]
    if not above:
        return
    yield f"an effect whose limit is above 20: {_counted(above)}"
    for lower, upper in _BINS:
        if inside := [e for e in above if lower < e.limit <= upper]:
            yield f"  {lower:g} to {upper:g}: {_counted(inside)}"
    for name in sorted({e.put_in for e in above}):
        yield f"  {name}: {_counted([e for e in above if e.put_in == name])}"


def _errors_said(draws: Sequence[Draw]) -> Iterator[str]:
    found = [one.error for one in draws if one.error]
    for name in sorted({one.put_in for one in found}):
        yield f"error of the model, {name}: {_counted([o for o in found if o.put_in == name])}"


def _counted(found: Sequence[Found]) -> str:
    named, listed = np.array([f.named for f in found]), np.array([f.named or f.listed for f in found])
    besides = np.array([bool(f.besides) for f in found])
    return f"named {_of(named)}, named or listed {_of(listed)}, something else besides {_of(besides)}"


def _of(true: BoolArray) -> str:
    return f"{np.mean(true):.1%} of {true.size}" if true.size else "none"


if __name__ == "__main__":
    sys.exit(main())
