"""What the image says for and against a contour, section by section; no tracker asks for it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.thermal.config import ContourConfig
from peopleboy.tracker.thermal.contour.contour import FEET
from peopleboy.tracker.thermal.contour.likelihood import (
    FEET_GAIN,
    ContourModel,
    clutter_of,
    covered_by,
    section_differences,
    seen_shares,
)
from peopleboy.tracker.thermal.ellipse import Ellipse
from peopleboy.tracker.thermal.explanation import ContourExplanation
from peopleboy.tracker.track import Track

_NOTHING = 1e-6  # share of a section that counts as none


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """How the image answers to one contour.

    Attributes:
        response: (8,) mean response of what is in view of each section, D_j of equation 4.3; NaN where
            nothing of it is in view. With a bent response it lies in -1..1, and more speaks for a person.
        seen: (8,) share of each section that is in the image and not covered by people in front.
    """

    response: NDArray[np.float64]
    seen: NDArray[np.float64]


def evidence_of(
    thermal: NDArray[np.uint8], tracks: Sequence[Track], explanation: ContourExplanation
) -> Mapping[int, Evidence]:
    """Measure the contours of tracks in their frame, by track id; whom a track names as occluder covers it.

    Args:
        thermal: (H, W) grey, as the tracker got it.
        tracks: what the tracker made of it.
        explanation: its contours of that frame.
    """
    config = explanation.config
    model = _model((thermal.shape[0], thermal.shape[1]), config.contour)
    image = model.prepare(thermal)
    model = model.amid(clutter_of(image))
    states = {track.id: _state(explanation.ellipses[track.id]) for track in tracks}
    evidence = {}
    for track in tracks:
        front = [states[track.occluder]] if track.occluder in states else []
        marked = covered_by(image, front, config.depth.growth)
        evidence[track.id] = _measure(marked, states[track.id], model)
    return evidence


def _measure(marked: NDArray[np.uint8], state: NDArray[np.float64], model: ContourModel) -> Evidence:
    """Measure what is in view of one contour, in a prepared image (H, W) with covered pixels marked."""
    seen = seen_shares(marked, state, model.probes)
    rows = state.astype(np.float32)[None]
    # Pairs out of view add nothing; the mean over the others follows from the mean over all.
    mean = section_differences(marked, rows, model.probes, model.response, 0.0, 0.0)[0].astype(np.float64)
    response = np.where(seen > _NOTHING, mean / np.maximum(seen, _NOTHING), np.nan)
    if model.config.feet_weight > 0:
        response[FEET] = np.minimum(1.0, FEET_GAIN * response[FEET])
    else:
        response[FEET] = np.nan
    return Evidence(response, seen)


@lru_cache(maxsize=4)
def _model(shape: tuple[int, int], config: ContourConfig) -> ContourModel:
    return ContourModel.build(shape, config)


def _state(ellipse: Ellipse) -> NDArray[np.float64]:
    """Give the (9,) state of an ellipse, at rest."""
    return np.array([ellipse.x, ellipse.y, ellipse.w, ellipse.h, ellipse.d, 0.0, 0.0, 0.0, 0.0])
