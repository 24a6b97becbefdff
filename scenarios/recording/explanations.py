"""Draw a tracker's explanation of its tracks, by kind of explanation.

On the thermal image these are contour sections and particles, or detections. On images of further cameras
these are lines and the background.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import singledispatch

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.pose2 import Pose2
from peopleboy.geometry.small_matrices import principal_axes
from peopleboy.scenarios.drawing.palette import Rgb, track_colour
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.recording.marks import (
    CHI_95,
    Colours,
    Lines,
    Points,
    colours_of,
    lines_of,
    particle_points,
)
from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.geometry.panorama import around_px
from peopleboy.sim.geometry.pinhole import CameraGeometry, invert_pose, transform
from peopleboy.tracker.frame import DEPTH, PANORAMA
from peopleboy.tracker.reproductions.attention.attentive_explanation import AttentiveExplanation
from peopleboy.tracker.reproductions.contour.explanation import DETECTOR_KEY, ContourExplanation
from peopleboy.tracker.reproductions.contour.measurement.contour import FEET, SECTIONS
from peopleboy.tracker.reproductions.contour.measurement.section_evidence import (
    Evidence,
    evidence_of,
    section_lines,
)
from peopleboy.tracker.reproductions.panoramic.depth_cues import MeasuredFigure
from peopleboy.tracker.reproductions.panoramic.paper_tracker import PanoramicExplanation
from peopleboy.tracker.reproductions.rgbd.rgbd_tracker import RgbdExplanation
from peopleboy.tracker.sensors.depth.depth_sensor import DepthExplanation
from peopleboy.tracker.sensors.panorama.panorama_sensor import PanoramaExplanation
from peopleboy.tracker.sensors.thermal.thermal_sensor import DetectionExplanation
from peopleboy.tracker.track import Box, FloorPlace, Track
from peopleboy.tracker.tracking.sensor import parts_of

# ColorBrewer's RdYlBu without its dark ends: against a person, undecided, for a person; in thresholds.
_STEPS = (0.0, 1.0, 2.0)
_SHADES = np.array([(215, 48, 39), (255, 255, 191), (69, 117, 180)])
OUT_OF_VIEW: Rgb = (110, 110, 110)
LIKELY: Rgb = (116, 173, 209)
UNLIKELY: Rgb = (110, 110, 110)
_CORNERS = 4  # of a box
_ARM = 0.3  # of a corner, as a share of the box's width
_HALF = 0.5  # least visible share of a section
HISTOGRAM: Rgb = (245, 245, 245)
NOBODYS: Rgb = (150, 150, 150)
VERIFIED: Rgb = (245, 245, 245)
_BAR_PX = 0.3  # height of a bar per pixel that is set in a column
_ROUND = np.linspace(0.0, 2.0 * np.pi, 49)

Line = NDArray[np.float64]


@singledispatch
def draw_explained_lines(explanation: object, tick: Tick) -> Lines:
    """Return lines on the thermal image that explain a tick's tracks; none for an unknown kind.

    A new kind of explanation registers its drawing function for recordings here and below; a combined
    explanation is drawn part by part.
    """
    drawn = (draw_explained_lines(part, tick) for part in parts_of(explanation))
    nothing = Lines(lines_of([], 2), colours_of([]))
    return next((lines for lines in drawn if len(lines.line)), nothing)


@draw_explained_lines.register
def _(explanation: ContourExplanation, tick: Tick) -> Lines:
    tracks = tuple(track for track in tick.tracks if track.id in explanation.ellipses)
    evidence = evidence_of(tick.observation.images["thermal"], tracks, explanation)
    return section_marks(tracks, evidence, explanation)


@draw_explained_lines.register
def _(explanation: DetectionExplanation, tick: Tick) -> Lines:  # noqa: ARG001
    shades = [LIKELY if score > 0.0 else UNLIKELY for score in explanation.scores.tolist()]
    return Lines(
        lines_of([corner for box in explanation.boxes for corner in box_corners(box)], 2),
        colours_of([shade for shade in shades for _ in range(_CORNERS)]),
    )


@singledispatch
def draw_explained_points(explanation: object) -> Mapping[str, Points]:
    """Return points on the thermal image that explain a tick's tracks, by layer."""
    return {
        layer: points
        for part in parts_of(explanation)
        for layer, points in draw_explained_points(part).items()
    }


@draw_explained_points.register
def _(explanation: ContourExplanation) -> Mapping[str, Points]:
    clouds = explanation.particles
    people = {number: cloud for number, cloud in clouds.items() if number != DETECTOR_KEY}
    detector = {number: cloud for number, cloud in clouds.items() if number == DETECTOR_KEY}
    return {"particles/people": particle_points(people), "particles/detector": particle_points(detector)}


def likeness_by_track(explanation: object) -> Mapping[int, float]:
    """Return the similarity to the learned person, 0..1, by track; empty if the tracker compares none."""
    return explanation.likeness if isinstance(explanation, AttentiveExplanation) else {}


def box_corners(box: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the corners of a box (4,) [px] as lines (4, 3, 2), so that the track's own box stays visible."""
    left, top, width, height = box
    arm = _ARM * width
    inwards = np.array([(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)])
    corner = (left, top) + (inwards < 0.0) * (width, height)
    aside, down = inwards * (arm, 0.0), inwards * (0.0, arm)
    return np.stack([corner + aside, corner, corner + down], axis=1)


def section_marks(
    tracks: Sequence[Track], evidence: Mapping[int, Evidence], explanation: ContourExplanation
) -> Lines:
    """Draw every contour section of every track, coloured by its evidence.

    Red is evidence against a person, pale yellow is undecided (the threshold of the fitness), and blue is
    evidence for a person. Sections that are mostly hidden or outside the image are grey. The hips, which no
    tracker measures, have the colour of the track.
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
    """Return the colours (8, 3) of the sections."""
    responses = np.nan_to_num(evidence.response) / threshold
    shades = np.stack([np.interp(responses, _STEPS, channel) for channel in _SHADES.T], axis=1)
    return np.where((evidence.seen >= _HALF)[:, None], np.rint(shades), OUT_OF_VIEW).astype(np.uint8)


@dataclass(frozen=True, slots=True, eq=False)
class Sketch:
    """The explanation of the newest image of one camera.

    Attributes:
        background: (H, W) or (H, W, 3) the tracker's background image; None without one.
        lines: K lines of (n, 2) [px].
        colour: (K, 3).
    """

    background: NDArray[np.uint8] | None
    lines: list[Line]
    colour: Colours

    @classmethod
    def of(cls, background: NDArray[np.uint8] | None, coloured: Sequence[tuple[Line, Rgb]]) -> "Sketch":
        """Make a sketch of lines, each with its colour."""
        return cls(background, [line for line, _ in coloured], colours_of(colour for _, colour in coloured))


@singledispatch
def draw_explained_sketches(
    explanation: object, tracks: Sequence[Track], cameras: Mapping[str, CameraConfig]
) -> Mapping[str, Sketch]:
    """Return the explanations of further cameras' images by camera; none for an unknown kind.

    A new kind of explanation registers its drawing function for recordings here; a combined explanation is
    drawn part by part.
    """
    return {
        name: sketch
        for part in parts_of(explanation)
        for name, sketch in draw_explained_sketches(part, tracks, cameras).items()
    }


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
    coloured += [(line, own) for line, _ in _floor_ellipses(tracks, camera)]
    background = np.rint(explanation.background.mean).astype(np.uint8)
    return {PANORAMA: Sketch.of(background if background.shape[2] == 3 else background[:, :, 0], coloured)}


@draw_explained_sketches.register
def _(
    explanation: PanoramaExplanation, tracks: Sequence[Track], cameras: Mapping[str, CameraConfig]
) -> Mapping[str, Sketch]:
    camera = cameras[PANORAMA].camera
    if explanation.foreground.shape != (camera.height, camera.width):
        return {}  # resampled into another view
    found = [(line, NOBODYS) for line in outlines_of(explanation.foreground > 0.5)]
    coloured = found + _floor_ellipses(tracks, camera)
    return {PANORAMA: Sketch.of(explanation.background, coloured)}


@draw_explained_sketches.register
def _(
    explanation: RgbdExplanation, tracks: Sequence[Track], cameras: Mapping[str, CameraConfig]
) -> Mapping[str, Sketch]:
    found = [
        (_frame(one.found.box), VERIFIED if one.is_verified else NOBODYS) for one in explanation.detections
    ]
    return {DEPTH: Sketch.of(None, found + _floor_ellipses(tracks, cameras[DEPTH].camera))}


@draw_explained_sketches.register
def _(
    explanation: DepthExplanation, tracks: Sequence[Track], cameras: Mapping[str, CameraConfig]
) -> Mapping[str, Sketch]:
    found = [
        (_frame(box), VERIFIED if score > 0.0 else NOBODYS)
        for box, score in zip(explanation.boxes, explanation.scores, strict=False)
    ]
    return {DEPTH: Sketch.of(None, found + _floor_ellipses(tracks, cameras[DEPTH].camera))}


@draw_explained_sketches.register
def _(
    explanation: AttentiveExplanation, tracks: Sequence[Track], cameras: Mapping[str, CameraConfig]
) -> Mapping[str, Sketch]:
    below, attended = draw_explained_sketches(explanation.below, tracks, cameras), explanation.attended
    if attended is None or attended.camera in below:
        return below
    focus, own = attended.focus(), track_colour(attended.number)
    lines = [_frame(focus.box), *_cross(focus.place, 0.1 * focus.box[3])]
    background = _brightened(focus.scores, attended.image.shape)
    return {**below, attended.camera: Sketch.of(background, [(line, own) for line in lines])}


def _floor_ellipses(tracks: Sequence[Track], camera: CameraGeometry) -> list[tuple[Line, Rgb]]:
    """Draw the `floor_ellipse` of every track with a position, in the track's colour."""
    return [
        (line, track_colour(track.id))
        for track in tracks
        if track.place is not None
        for line in floor_ellipse(track.place, camera)
    ]


def outlines_of(mask: NDArray[np.bool_]) -> list[Line]:
    """Return closed lines (n, 2) through the outermost pixels of all regions set in an image (H, W)."""
    # Enlarged to 2 x 2 pixels, a single pixel has an outline too.
    fine = np.repeat(np.repeat(np.asarray(mask, np.uint8), 2, axis=0), 2, axis=1)
    found, _ = cv2.findContours(fine, cv2.RETR_LIST, cv2.CHAIN_APPROX_SIMPLE)
    return [(np.concatenate([line, line[:1]])[:, 0] - 0.5) / 2.0 for line in found]


def column_bars(figure: MeasuredFigure) -> list[Line]:
    """Draw the histogram of columns along the lower border, from the person's first column to the last."""
    width, bottom = len(figure.columns), len(figure.rows) - 0.5
    columns = figure.first_column + np.arange(int(figure.cues.width_px))
    heights = bottom - _BAR_PX * figure.columns[columns % width]
    sides = (columns < width, columns >= width)
    return [_steps(columns[side] % width, heights[side], bottom) for side in sides if side.any()]


def row_bars(figure: MeasuredFigure) -> Line:
    """Draw the histogram of rows beside the person, on the right if there is room."""
    left, _, width, _ = figure.box
    is_right = left + 2.0 * width < len(figure.columns)
    edge, way = (left + width, 1.0) if is_right else (left, -1.0)
    rows = np.arange(*np.flatnonzero(figure.rows)[[0, -1]] + (0, 1))
    return _steps(rows, edge + way * figure.rows[rows], edge)[:, ::-1]


def floor_ellipse(place: FloorPlace, camera: CameraGeometry) -> list[Line]:
    """Draw the 95 % ellipse of a person's floor position, split at the seam."""
    xx, xy, yy = place.covariance_m2
    variances, angle = principal_axes(xx, xy, yy)
    axes = Pose2(heading=angle).rotation
    ring = np.stack([np.cos(_ROUND), np.sin(_ROUND)], axis=1) * np.sqrt(np.maximum(variances, 0.0))
    floor = np.zeros((len(_ROUND), 3))
    floor[:, :2] = np.array(place.position_m) + CHI_95 * ring @ axes.T
    pixels = camera.project(transform(invert_pose(camera.robot_from_camera), floor))
    return list(_parts(pixels[~np.isnan(pixels).any(axis=1)], around_px(camera)))


def _frame(box: Box) -> Line:
    """Return the closed outline (5, 2) of a box."""
    left, top, width, height = box
    right, bottom = left + width, top + height
    return np.array([(left, top), (right, top), (right, bottom), (left, bottom), (left, top)])


def _cross(place: tuple[float, float], reach: float) -> list[Line]:
    """Return an upright cross, lines (2, 2) and (2, 2), at a point."""
    u, v = place
    return [np.array([(u - reach, v), (u + reach, v)]), np.array([(u, v - reach), (u, v + reach)])]


def _brightened(scores: NDArray[np.float64], shape: tuple[int, ...]) -> NDArray[np.uint8]:
    """Return scores 0..1 as a brightened image with the (H, W) of a camera's image."""
    grey = np.rint(255.0 * np.sqrt(np.clip(scores, 0.0, 1.0))).astype(np.uint8)
    size = (shape[1], shape[0])
    return np.asarray(cv2.resize(grey, size, interpolation=cv2.INTER_LINEAR), np.uint8)


def _parts(line: Line, around: float) -> Iterator[Line]:
    """Split a line (n, 2) where it crosses the seam; single points are dropped."""
    jumps = np.flatnonzero(np.abs(np.diff(line[:, 0])) > around / 2.0) + 1
    yield from (part for part in np.split(line, jumps) if len(part) > 1)


def _steps(places: NDArray[np.int64], ends: NDArray[np.floating], base: float) -> Line:
    """Return a bar chart, bars one pixel wide on a common base, as one line (2 n + 2, 2)."""
    sides = np.repeat(places, 2) + np.tile([-0.5, 0.5], len(places))
    heights = np.repeat(ends, 2)
    return np.stack([np.r_[sides[0], sides, sides[-1]], np.r_[base, heights, base]], axis=1)
