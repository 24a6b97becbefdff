"""Evidence of the image for and against a contour, section by section; for analysis only."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.reproductions.contour.contour_config import ContourConfig
from peopleboy.tracker.reproductions.contour.explanation import ContourExplanation, Ellipse
from peopleboy.tracker.reproductions.contour.measurement.contour import (
    FEET,
    FEET_SPAN,
    HEAD_LEFT,
    HEAD_RIGHT,
    HEAD_TOP,
    SECTIONS,
    SIDE_RIGHT,
    body_points,
    head_points,
    section_angles,
)
from peopleboy.tracker.reproductions.contour.measurement.likelihood import (
    FEET_GAIN,
    ContourModel,
    clutter_of,
    covered_by,
    section_differences,
    seen_shares,
)
from peopleboy.tracker.reproductions.contour.particles import FOOT
from peopleboy.tracker.track import Track

_NOTHING = 1e-6  # share of a section that counts as zero


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """Evidence for one contour.

    Attributes:
        response: (8,) mean response of the visible part of each section, D_j of equation 4.3; NaN if nothing
            of it is visible. With a saturated response it lies in -1..1, and larger values indicate a person.
        seen: (8,) share of each section inside the image and not covered by people in front.
    """

    response: NDArray[np.float64]
    seen: NDArray[np.float64]


def evidence_of(
    thermal: NDArray[np.uint8], tracks: Sequence[Track], explanation: ContourExplanation
) -> Mapping[int, Evidence]:
    """Measure the contours of tracks in their frame, by track id, each covered by its occluder.

    Args:
        thermal: (H, W) grey, the tracker's input.
        tracks: the tracker's output.
        explanation: its contours in that frame.
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
    """Measure the visible part of one contour, in a preprocessed image (H, W) with covered pixels marked."""
    seen = seen_shares(marked, state, model.probes)
    rows = state.astype(np.float32)[None]
    # Invisible pairs add nothing; the mean over the others follows from the mean over all.
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
    """Return the (9,) state of an ellipse, at rest."""
    return np.array([ellipse.x, ellipse.y, ellipse.w, ellipse.h, ellipse.d, 0.0, 0.0, 0.0, 0.0])


# The outline of a contour, for drawing.


def outline(ellipse: Ellipse, count: int = 48) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the outlines of body and head as two closed lines (count, 2) [px]."""
    angle = np.linspace(0.0, 2 * np.pi, count)
    nothing = np.zeros(count)
    mix = np.array([ellipse.d, ellipse.w, ellipse.h, 1.0])
    centre = np.array([ellipse.x, ellipse.y])
    return centre + body_points(angle, nothing, 0.0) @ mix, centre + head_points(angle, nothing, 0.0) @ mix


def section_lines(ellipse: Ellipse, config: ContourConfig) -> NDArray[np.float64]:
    """Return a line (9, K, 2) [px] along every section, in order with the feet, and one round the hips.

    The last one closes the body's ellipse, where no section is.
    """
    mix = np.array([ellipse.d, ellipse.w, ellipse.h, 1.0])
    lines: NDArray[np.float64] = _section_points(config) @ mix + (ellipse.x, ellipse.y)
    return lines


@lru_cache(maxsize=8)
def _section_points(config: ContourConfig, count: int = 5) -> NDArray[np.float64]:
    """Return the coefficients (9, count, 2, 4) of d, w, h and 1 for the points of `section_lines`."""
    points, nothing = np.zeros((SECTIONS + 1, count, 2, 4)), np.zeros(count)
    arcs = section_angles(config)
    side_end = arcs[SIDE_RIGHT][1]
    for line, (start, end) in {**arcs, SECTIONS: (side_end, 2.0 * np.pi - side_end)}.items():
        angle = np.linspace(start, end, count)
        if line in (HEAD_LEFT, HEAD_TOP, HEAD_RIGHT):
            points[line] = head_points(angle, nothing, 0.0)
        else:
            points[line] = body_points(angle, nothing, 0.0)
    points[FEET, :, 0, 2] = np.linspace(-FEET_SPAN, FEET_SPAN, count)
    points[FEET, :, 1, 2] = FOOT
    points.setflags(write=False)
    return points
