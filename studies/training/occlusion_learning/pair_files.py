"""Examples of overlapping people as a CSV table, so that training can be repeated without a run."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.studies.training.occlusion_learning.occlusion_pairs import PairExample
from peopleboy.tracker.contour.occlusion.pair_features import FEATURES

_COLUMNS = ("scenario", "seed", "frame", "one", "other", *FEATURES, "is_front")


def write_pairs(path: Path, examples: Sequence[PairExample]) -> None:
    """Write examples as a CSV table."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(_COLUMNS)
        for e in examples:
            numbers = [f"{value:.6g}" for value in e.features]
            writer.writerow([e.scenario, e.seed, e.frame, e.one, e.other, *numbers, int(e.is_front)])


def read_pairs(path: Path) -> list[PairExample]:
    """Read such a table.

    Raises:
        BadInput: a file that is missing or is no such table.
    """
    try:
        with path.open(newline="", encoding="utf-8") as file:
            return [_parse(row) for row in csv.DictReader(file)]
    except OSError as error:
        raise BadInput(f"{path}: cannot be read: {error.strerror}") from None
    except (KeyError, ValueError, TypeError) as error:
        raise BadInput(f"{path}: must be a table of {', '.join(_COLUMNS)}; {error!r}") from None


def _parse(row: dict[str, str]) -> PairExample:
    features = np.array([float(row[name]) for name in FEATURES])
    if not np.isfinite(features).all():
        raise ValueError(f"features must be finite, got {features}")
    return PairExample(
        scenario=row["scenario"],
        seed=int(row["seed"]),
        frame=int(row["frame"]),
        one=row["one"],
        other=row["other"],
        features=features,
        is_front=bool(int(row["is_front"])),
    )
