"""`python -m benchmarks.speed.laser`: precision and time of detections in laser scans of unseen worlds.

The networks were trained on random scenes and worlds with other seeds, see `peopleboy train legs`.
"""

import json
from collections.abc import Sequence
from functools import partial
from typing import Any, Final

import click
import numpy as np

from benchmarks import call
from benchmarks.compare import spent_ms
from peopleboy.scenarios.random_worlds.random_world import random_scenario
from peopleboy.studies.training.legs import FARTHEST_M, RADIUS_M, Scans, detect_all, scan_scenario
from peopleboy.tracker.evaluation.floor import average_precision
from peopleboy.tracker.frame import LASER
from peopleboy.tracker.networks.inference import one_thread
from peopleboy.tracker.sensors.laser.leg_model import LegModel

FIRST: Final = 9_100
"""First seed of the worlds, none of which the networks were trained on or chosen by."""
STEPS_DEG: Final = (0.5, 0.25)
_RATE_HZ: Final = 5
_TIMED: Final = 200  # scans, at most
_COMPILED: Final = 3  # scans after which all kernels are compiled


def measure(model: LegModel, sequences: Sequence[Scans]) -> dict[str, Any]:
    """Return average precision, position error and CPU time of detection in scans of one size."""
    frames = detect_all(model, sequences)
    score, strict = average_precision(frames, RADIUS_M), average_precision(frames, RADIUS_M / 2.0)
    scans = [(ranges, one.calibration) for one in sequences for ranges in one.ranges][: _TIMED + _COMPILED]
    with one_thread():
        times = [spent_ms(partial(model.detect, *scan)) for scan in scans][_COMPILED:]
    return {
        "scans": len(frames),
        "people": score.people,
        "average_precision": score.average_precision,
        "average_precision_strict": strict.average_precision,
        "error_m": score.error_m,
        "scan_ms": float(np.median(times)),
    }


def scan_world(seed: int, step_deg: float) -> Scans:
    """Scan the random world of a seed by a range finder with 180 degrees."""
    settings = {"kind": LASER, "rate_hz": _RATE_HZ, "step_deg": step_deg}
    return scan_scenario(random_scenario(seed).with_cameras({LASER: settings}), seed)


@click.command()
@click.option("--worlds", default=40, show_default=True, help="Number of random worlds.")
def main(worlds: int) -> None:
    """Print results as JSON, by number of beams: average precision at 0.5 m and 0.25 m, error, and time."""
    model, found = LegModel.load(), {}
    for step_deg in STEPS_DEG:
        sequences = [scan_world(seed, step_deg) for seed in range(FIRST, FIRST + worlds)]
        beams = sequences[0].calibration.beams
        found[f"{beams} beams"] = measure(model, sequences) | {"farthest_m": FARTHEST_M}
    click.echo(json.dumps(found, indent=2))


if __name__ == "__main__":
    call(main, "benchmarks.speed.laser")
