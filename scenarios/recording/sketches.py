"""What a tracker explains of the image of a further camera: lines on it, and the scene without people."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import singledispatch

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.drawing.palette import Rgb, track_colour
from peopleboy.scenarios.recording.marks import CHI_95, Colours, colours_of
from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.geometry.camera_geometry import CameraGeometry
from peopleboy.sim.geometry.panorama import around_px
from peopleboy.sim.geometry.pinhole import invert_pose, transform
from peopleboy.tracker.attention.people.attentive_explanation import AttentiveExplanation
from peopleboy.tracker.frame import DEPTH, PANORAMA
from peopleboy.tracker.fusion.fused_explanations import BothExplanations, FusedExplanation
from peopleboy.tracker.panoramic.paper.depth_cues import MeasuredFigure
from peopleboy.tracker.panoramic.paper.paper_tracker import PanoramicExplanation
from peopleboy.tracker.panoramic.people.panoramic_observation import PeopleExplanation
from peopleboy.tracker.rgbd.rgbd_tracker import RgbdExplanation
from peopleboy.tracker.track import Box, FloorPlace, Track

Line = NDArray[np.float64]

HISTOGRAM: Rgb = (245, 245, 245)
NOBODYS: Rgb = (150, 150, 150)
VERIFIED: Rgb = (245, 245, 245)
_BAR_PX = 0.3  # height of a bar for each pixel that a column has
_ROUND = np.linspace(0.0, 2.0 * np.pi, 49)


@dataclass(frozen=True, slots=True, eq=False)
class Sketch:
    """What explains the newest image of one camera.

    Attributes:
        background: (H, W) or (H, W, 3) the empty scene as the tracker knows it; None if it knows none.
        lines: K lines of (n, 2) [px].
        colour: (K, 3).
    """

    background: NDArray[np.uint8] | None
    lines: list[Line]
    colour: Colours


@singledispatch
def draw_explained_sketches(
    explanation: object,  # noqa: ARG001
    tracks: Sequence[Track],  # noqa: ARG001
    cameras: Mapping[str, CameraConfig],  # noqa: ARG001
) -> Mapping[str, Sketch]:
    """Give what explains tracks in further cameras' images, by camera; nothing for a kind nobody can draw.

    A new kind of explanation registers here how it is drawn in recordings.
    """
    return {}


@draw_explained_sketches.register
def _(
    explanation: PanoramicExplanation, tracks: Sequence[Track], cameras: Mapping[str, CameraConfig]
) -> Mapping[str, Sketch]:
    camera, figure = cameras[PANORAMA].camera, explanation.figure
    own = track_colour(tracks[0].id) if tracks else NOBODYS
    coloured = [(line, own) for line in outlines_of(explanation.silhouette)]
    if figure is not None:
        coloured += [(line, HISTOGRAM) for line in (*column_bars(figure), row_bars(figure))]
        middle = np.array([[figure.mean_column, -0.5], [figure.mean_column, camera.height - 0.5]])
        coloured.append((middle, own))
    places = [track.place for track in tracks if track.place is not None]
    coloured += [(line, own) for place in places for line in floor_ellipse(place, camera)]
    background = np.rint(explanation.background.mean).astype(np.uint8)
    sketch = Sketch(
        background if background.shape[2] == 3 else background[:, :, 0],
        [line for line, _ in coloured],
        colours_of(colour for _, colour in coloured),
    )
    return {PANORAMA: sketch}


@draw_explained_sketches.register
def _(
    explanation: PeopleExplanation, tracks: Sequence[Track], cameras: Mapping[str, CameraConfig]
) -> Mapping[str, Sketch]:
    camera = cameras[PANORAMA].camera
    coloured = [(line, NOBODYS) for line in outlines_of(explanation.foreground > 0.5)]
    for track in tracks:
        if track.place is not None:
            own = track_colour(track.id)
            coloured += [(line, own) for line in floor_ellipse(track.place, camera)]
    sketch = Sketch(
        explanation.background, [line for line, _ in coloured], colours_of(colour for _, colour in coloured)
    )
    return {PANORAMA: sketch}


@draw_explained_sketches.register
def _(
    explanation: BothExplanations, tracks: Sequence[Track], cameras: Mapping[str, CameraConfig]
) -> Mapping[str, Sketch]:
    return draw_explained_sketches(explanation.panoramic, tracks, cameras)


@draw_explained_sketches.register
def _(
    explanation: RgbdExplanation, tracks: Sequence[Track], cameras: Mapping[str, CameraConfig]
) -> Mapping[str, Sketch]:
    coloured = [
        (_frame(one.found.box), VERIFIED if one.is_verified else NOBODYS) for one in explanation.detections
    ]
    for track in tracks:
        if track.place is not None:
            own = track_colour(track.id)
            coloured += [(line, own) for line in floor_ellipse(track.place, cameras[DEPTH].camera)]
    sketch = Sketch(None, [line for line, _ in coloured], colours_of(colour for _, colour in coloured))
    return {DEPTH: sketch}


@draw_explained_sketches.register
def _(
    explanation: FusedExplanation, tracks: Sequence[Track], cameras: Mapping[str, CameraConfig]
) -> Mapping[str, Sketch]:
    parts = (explanation.both, explanation.depth)
    return {
        name: sketch
        for part in parts
        for name, sketch in draw_explained_sketches(part, tracks, cameras).items()
    }


@draw_explained_sketches.register
def _(
    explanation: AttentiveExplanation, tracks: Sequence[Track], cameras: Mapping[str, CameraConfig]
) -> Mapping[str, Sketch]:
    below, attended = draw_explained_sketches(explanation.below, tracks, cameras), explanation.attended
    if attended is None or attended.camera in below:
        return below
    focus, own = attended.focus(), track_colour(attended.number)
    lines = [_frame(focus.box), *_cross(focus.place, 0.1 * focus.box[3])]
    sketch = Sketch(_brightened(focus.scores, attended.image.shape), lines, colours_of([own] * len(lines)))
    return {**below, attended.camera: sketch}


def outlines_of(mask: NDArray[np.bool_]) -> list[Line]:
    """Trace closed lines (n, 2) round all that is set in an image (H, W), through its outermost pixels."""
    # Pixels of two by two have outlines even if they are alone.
    fine = np.repeat(np.repeat(np.asarray(mask, np.uint8), 2, axis=0), 2, axis=1)
    found, _ = cv2.findContours(fine, cv2.RETR_LIST, cv2.CHAIN_APPROX_SIMPLE)
    return [(np.concatenate([line, line[:1]])[:, 0] - 0.5) / 2.0 for line in found]


def column_bars(figure: MeasuredFigure) -> list[Line]:
    """Draw the histogram of columns along the lower border, from the person's first to its last column."""
    width, bottom = len(figure.columns), len(figure.rows) - 0.5
    columns = figure.first_column + np.arange(int(figure.cues.width_px))
    heights = bottom - _BAR_PX * figure.columns[columns % width]
    sides = (columns < width, columns >= width)
    return [_steps(columns[side] % width, heights[side], bottom) for side in sides if side.any()]


def row_bars(figure: MeasuredFigure) -> Line:
    """Draw the histogram of rows beside the person, to the right if there is room for it."""
    left, _, width, _ = figure.box
    is_right = left + 2.0 * width < len(figure.columns)
    edge, way = (left + width, 1.0) if is_right else (left, -1.0)
    rows = np.arange(*np.flatnonzero(figure.rows)[[0, -1]] + (0, 1))
    return _steps(rows, edge + way * figure.rows[rows], edge)[:, ::-1]


def floor_ellipse(place: FloorPlace, camera: CameraGeometry) -> list[Line]:
    """Draw the ellipse on the floor that holds 95 % of where a person may stand, in parts at the seam."""
    xx, xy, yy = place.covariance_m2
    variance, axes = np.linalg.eigh(np.array([[xx, xy], [xy, yy]]))
    ring = np.stack([np.cos(_ROUND), np.sin(_ROUND)], axis=1) * np.sqrt(np.maximum(variance, 0.0))
    floor = np.zeros((len(_ROUND), 3))
    floor[:, :2] = np.array(place.position_m) + CHI_95 * ring @ axes.T
    pixels = camera.project(transform(invert_pose(camera.robot_from_camera), floor))
    return list(_parts(pixels[~np.isnan(pixels).any(axis=1)], around_px(camera)))


def _frame(box: Box) -> Line:
    """Draw a box (5, 2)."""
    left, top, width, height = box
    right, bottom = left + width, top + height
    return np.array([(left, top), (right, top), (right, bottom), (left, bottom), (left, top)])


def _cross(place: tuple[float, float], reach: float) -> list[Line]:
    """Draw an upright cross (2, 2) and (2, 2) about a place."""
    u, v = place
    return [np.array([(u - reach, v), (u + reach, v)]), np.array([(u, v - reach), (u, v + reach)])]


def _brightened(scores: NDArray[np.float64], shape: tuple[int, ...]) -> NDArray[np.uint8]:
    """Draw scores 0..1 as an image (H, W) of an image's size, brighter than they are."""
    grey = np.rint(255.0 * np.sqrt(np.clip(scores, 0.0, 1.0))).astype(np.uint8)
    size = (shape[1], shape[0])
    return np.asarray(cv2.resize(grey, size, interpolation=cv2.INTER_LINEAR), np.uint8)


def _parts(line: Line, around: float) -> Iterator[Line]:
    """Cut a line (n, 2) where it goes on at the other border; lone points are left out."""
    jumps = np.flatnonzero(np.abs(np.diff(line[:, 0])) > around / 2.0) + 1
    yield from (part for part in np.split(line, jumps) if len(part) > 1)


def _steps(places: NDArray[np.int64], ends: NDArray[np.floating], base: float) -> Line:
    """Draw bars one pixel wide beside each other from a base, as one line (2 n + 2, 2)."""
    sides = np.repeat(places, 2) + np.tile([-0.5, 0.5], len(places))
    heights = np.repeat(ends, 2)
    return np.stack([np.r_[sides[0], sides, sides[-1]], np.r_[base, heights, base]], axis=1)
