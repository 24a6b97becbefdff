"""What a tracker explains beyond its tracks, drawn by its kind: of contours, their sections and samples."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import singledispatch

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.drawing.palette import Rgb, track_colour
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.recording.marks import Lines, Points, colours_of, lines_of, particle_points
from peopleboy.tracker.attention.people.attentive_explanation import AttentiveExplanation
from peopleboy.tracker.contour.explanation import DETECTOR_KEY, ContourExplanation
from peopleboy.tracker.contour.measurement.contour import FEET, SECTIONS
from peopleboy.tracker.contour.measurement.section_evidence import Evidence, evidence_of, section_lines
from peopleboy.tracker.fusion.fused_explanations import BothExplanations, FusedExplanation
from peopleboy.tracker.track import Track
from peopleboy.tracker.tracking.association import DetectionExplanation

# ColorBrewer's RdYlBu without its dark ends: against a person, undecided, for one; in thresholds.
_STEPS = (0.0, 1.0, 2.0)
_SHADES = np.array([(215, 48, 39), (255, 255, 191), (69, 117, 180)])
OUT_OF_VIEW: Rgb = (110, 110, 110)
LIKELY: Rgb = (116, 173, 209)
UNLIKELY: Rgb = (110, 110, 110)
_CORNERS = 4  # of a box
_ARM = 0.3  # of a corner, as a share of the box's width
_HALF = 0.5  # share of a section that must be in view


@singledispatch
def draw_explained_lines(explanation: object, tick: Tick) -> Lines:  # noqa: ARG001
    """Give the lines on the thermal image that explain a tick's tracks; none for a kind nobody can draw.

    A new kind of explanation registers here, and below, how it is drawn in recordings.
    """
    return Lines(lines_of([], 2), colours_of([]))


@draw_explained_lines.register
def _(explanation: ContourExplanation, tick: Tick) -> Lines:
    evidence = evidence_of(tick.observation.images["thermal"], tick.tracks, explanation)
    return section_marks(tick.tracks, evidence, explanation)


@draw_explained_lines.register
def _(explanation: DetectionExplanation, tick: Tick) -> Lines:  # noqa: ARG001
    shades = [LIKELY if score > 0.0 else UNLIKELY for score in explanation.scores.tolist()]
    return Lines(
        lines_of([corner for box in explanation.boxes for corner in box_corners(box)], 2),
        colours_of([shade for shade in shades for _ in range(_CORNERS)]),
    )


@draw_explained_lines.register
def _(explanation: BothExplanations, tick: Tick) -> Lines:
    warm = tuple(track for track in tick.tracks if track.id in explanation.thermal.ellipses)
    return draw_explained_lines(explanation.thermal, replace(tick, tracks=warm))


@draw_explained_lines.register
def _(explanation: FusedExplanation, tick: Tick) -> Lines:
    return draw_explained_lines(explanation.both, tick)


@draw_explained_lines.register
def _(explanation: AttentiveExplanation, tick: Tick) -> Lines:
    return draw_explained_lines(explanation.below, tick)


@singledispatch
def draw_explained_points(explanation: object) -> Mapping[str, Points]:  # noqa: ARG001
    """Give the points on the thermal image that explain a tick's tracks, by the layer that they lie in."""
    return {}


@draw_explained_points.register
def _(explanation: ContourExplanation) -> Mapping[str, Points]:
    clouds = explanation.particles
    people = {number: cloud for number, cloud in clouds.items() if number != DETECTOR_KEY}
    detector = {number: cloud for number, cloud in clouds.items() if number == DETECTOR_KEY}
    return {"particles/people": particle_points(people), "particles/detector": particle_points(detector)}


@draw_explained_points.register
def _(explanation: BothExplanations) -> Mapping[str, Points]:
    return draw_explained_points(explanation.thermal)


@draw_explained_points.register
def _(explanation: FusedExplanation) -> Mapping[str, Points]:
    return draw_explained_points(explanation.both)


@draw_explained_points.register
def _(explanation: AttentiveExplanation) -> Mapping[str, Points]:
    return draw_explained_points(explanation.below)


@singledispatch
def likeness_by_track(explanation: object) -> Mapping[int, float]:  # noqa: ARG001
    """Give how much people look like who they are said to be, 0..1, by track; of trackers that compare."""
    return {}


@likeness_by_track.register
def _(explanation: AttentiveExplanation) -> Mapping[int, float]:
    return explanation.likeness


def box_corners(box: NDArray[np.float64]) -> NDArray[np.float64]:
    """Draw the corners of a box (4,) [px] as lines (4, 3, 2), which leave the track's own box to be seen."""
    left, top, width, height = box
    arm = _ARM * width
    inwards = np.array([(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)])
    corner = (left, top) + (inwards < 0.0) * (width, height)
    aside, down = inwards * (arm, 0.0), inwards * (0.0, arm)
    return np.stack([corner + aside, corner, corner + down], axis=1)


def section_marks(
    tracks: Sequence[Track], evidence: Mapping[int, Evidence], explanation: ContourExplanation
) -> Lines:
    """Draw every section of every track, from red, against a person, by pale yellow, undecided, to blue.

    Undecided is the threshold of the fitness. What is mostly hidden or outside the image is grey. The hips,
    where no tracker looks, have the colour of the track.
    """
    config = explanation.config
    drawn = np.ones(SECTIONS + 1, np.bool_)
    drawn[FEET] = config.contour.feet_weight > 0
    lines: list[NDArray[np.float64]] = []
    colours = np.zeros((len(tracks), SECTIONS + 1, 3), np.uint8)
    for number, track in enumerate(tracks):
        lines.extend(section_lines(explanation.ellipses[track.id], config.contour)[drawn])
        colours[number, :SECTIONS] = _shades(evidence[track.id], config.likelihood.threshold)
        colours[number, SECTIONS] = track_colour(track.id)
    return Lines(lines_of(lines, 2), colours[:, drawn].reshape(-1, 3))


def _shades(evidence: Evidence, threshold: float) -> NDArray[np.uint8]:
    """Colour the sections (8, 3)."""
    responses = np.nan_to_num(evidence.response) / threshold
    shades = np.stack([np.interp(responses, _STEPS, channel) for channel in _SHADES.T], axis=1)
    return np.where((evidence.seen >= _HALF)[:, None], np.rint(shades), OUT_OF_VIEW).astype(np.uint8)
