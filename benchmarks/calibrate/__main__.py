"""python -m benchmarks.calibrate NAME --draws N --seed S --jobs J: the simulation that a rule comes from."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from benchmarks.calibrate import (
    amplitudes,
    colours,
    conditions,
    covariates,
    driven,
    few_cycles,
    force_tables,
    forces_together,
    pair_promise,
    pairs_apart,
    posterior,
    screen_share,
    second_term,
    tables,
    taken,
    together,
    unseen,
)
from benchmarks.calibrate.calibration import Calibration, measured
from harness.core.errors import HarnessError, InputError

CALIBRATIONS: dict[str, Calibration] = {
    "second-term": second_term.CALIBRATION,
    "pairs-apart": pairs_apart.CALIBRATION,
    "screen-share": screen_share.CALIBRATION,
    "pair-promise": pair_promise.CALIBRATION,
    "force-posterior": posterior.FORCE,
    "few-cycles": few_cycles.CALIBRATION,
    "tables": tables.CALIBRATION,
    "force-tables": force_tables.CALIBRATION,
    "together": together.CALIBRATION,
    "conditions": conditions.CALIBRATION,
    "forces-together": forces_together.CALIBRATION,
    "driven": driven.CALIBRATION,
    "amplitudes": amplitudes.CALIBRATION,
    "covariates": covariates.CALIBRATION,
    "colours": colours.CALIBRATION,
    "taken": taken.CALIBRATION,
    "posterior": posterior.CALIBRATION,
    "unseen": unseen.CALIBRATION,
}
_OF_PLANT = {"tables": tables.of_plant}
"""Those that can be measured on recordings that are there."""


def main(argv: Sequence[str] | None = None) -> int:
    """Print a calibration; exit code."""
    about = "; ".join(f"{name}: {one.about}" for name, one in CALIBRATIONS.items())
    parser = argparse.ArgumentParser(prog="python -m benchmarks.calibrate", description=about)
    parser.add_argument("name", choices=CALIBRATIONS)
    parser.add_argument("--draws", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1, help="processes side by side")
    parser.add_argument(
        "--plant", type=Path, help="tables: a folder that python -m benchmarks.recordings machines left"
    )
    told = parser.parse_args(argv)
    try:
        print("\n".join(_lines(told)))
    except HarnessError as error:
        print(error, file=sys.stderr)
        return error.exit_code
    return 0


def _lines(told: argparse.Namespace) -> Sequence[str]:
    for option, value in (("--draws", told.draws), ("--jobs", told.jobs)):
        if value < 1:
            raise InputError(option, str(value), "a whole number of at least 1")
    if told.plant is not None and told.name not in _OF_PLANT:
        raise InputError("--plant", f"given with {told.name}", f"it goes with {' and '.join(_OF_PLANT)}")
    chosen = CALIBRATIONS[told.name] if told.plant is None else _OF_PLANT[told.name](told.plant)
    rows = measured(chosen.measure, told.seed, told.draws, told.jobs)
    return [f"{told.name}: seed {told.seed}, {told.draws} draws, {len(rows)} measured", *chosen.said(rows)]


if __name__ == "__main__":
    sys.exit(main())
