"""Which detection is whom."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import linear_sum_assignment

from peopleboy.tracker.rgbd.people.colour_histogram import similarity
from peopleboy.tracker.rgbd.people.detection import Detection
from peopleboy.tracker.rgbd.people.hypothesis import Hypothesis
from peopleboy.tracker.rgbd.rgbd_config import HypothesesConfig

_NEVER = 1e6
_BETWEEN_FRAMES_S = 0.1


def associate(
    people: Sequence[Hypothesis], detections: Sequence[Detection], time_s: float, config: HypothesesConfig
) -> dict[int, int]:
    """Match people and detections, each with at most one, so that distances are least in all (SA 4.5).

    Who looks otherwise counts as farther. Nobody is matched beyond the gate, which is wider far away and
    for who was not seen for long.

    Args:
        people: N, as they are expected.
        detections: M.
        time_s: now [s].
        config: settings.

    Returns:
        Index of the detection by index of the person.
    """
    if not people or not detections:
        return {}
    cost = np.full((len(people), len(detections)), _NEVER)
    for row, person in enumerate(people):
        for column, detection in enumerate(detections):
            apart = float(np.hypot(*(detection.place_m - person.place_m)))
            gate = _gate_m(person, detection, time_s, config)
            if apart < gate:
                unlike = 1.0 - similarity(person.body.appearance, detection.body.appearance)
                # Whoever is believed in goes first.
                doubt = 0.0 if person.id else 0.5
                cost[row, column] = apart / gate + config.looks_weight * unlike + doubt
    rows, columns = linear_sum_assignment(cost)
    return {int(r): int(c) for r, c in zip(rows, columns, strict=True) if cost[r, c] < _NEVER}


def _gate_m(person: Hypothesis, detection: Detection, time_s: float, config: HypothesesConfig) -> float:
    unseen_m = config.gate_m_s * max(time_s - person.seen_s - _BETWEEN_FRAMES_S, 0.0)
    return config.gate_m + config.gate_per_m * detection.found.z_m**2 + min(unseen_m, config.gate_m)
