"""People's comfort in finished runs, as their metrics.json has it."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.scores.by_tracker import Groups
from peopleboy.scenarios.scores.comfort.comfort_metrics import ComfortScore

_NAMES = tuple(field.name for field in fields(ComfortScore))


def comfort_by_tracker(groups: Groups) -> Mapping[str, ComfortScore]:
    """Give the means over the runs of each tracker; trackers whose runs tell nothing of it are left out.

    What is undefined in a run is left out of the mean.

    Raises:
        BadInput: a run has other figures than this version.
    """
    found = {tracker: [_figures(Path(run.name)) for run in runs] for tracker, runs in groups.items()}
    told = {tracker: [figures for figures in runs if figures is not None] for tracker, runs in found.items()}
    return {tracker: _mean(runs) for tracker, runs in told.items() if runs}


def _figures(folder: Path) -> list[float] | None:
    """The figures of a run in the order of the score's; None if it has none."""
    path = folder / "metrics.json"
    if not path.is_file():
        return None
    group = json.loads(path.read_text(encoding="utf-8")).get("comfort")
    if group is None:
        return None
    if not isinstance(group, dict) or set(group) != set(_NAMES):
        raise BadInput(f"{path}: comfort: not the figures of this version; run the scenario again")
    return [math.nan if group[name] is None else float(group[name]) for name in _NAMES]


def _mean(runs: list[list[float]]) -> ComfortScore:
    table = np.array(runs)
    means = [float(np.nanmean(c)) if np.isfinite(c).any() else math.nan for c in table.T]
    return ComfortScore(**dict(zip(_NAMES, means, strict=True)))
