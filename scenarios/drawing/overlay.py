"""Draw tracks and ground truth on images.

Coordinates are pixels of the camera's own image. They are drawn on an enlarged image, so that lines stay thin
compared with people.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import singledispatch
from itertools import pairwise
from typing import Any, Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.drawing.palette import TRUTH, Rgb, faded, paled, track_colour
from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.cameras.kinds import colour_from_thermal, shown_to_people
from peopleboy.sim.geometry.panorama import around_px
from peopleboy.sim.geometry.pinhole import CameraGeometry, Matrix
from peopleboy.sim.truth.truth import PersonTruth
from peopleboy.tracker.boxes import Box, corners
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.reproductions.attention.attentive_explanation import AttentiveExplanation
from peopleboy.tracker.reproductions.contour.explanation import ContourExplanation
from peopleboy.tracker.reproductions.contour.measurement.section_evidence import outline
from peopleboy.tracker.track import Status, Track

Line = NDArray[np.float64]  # (K, 2) [px] in the thermal image


@singledispatch
def lines_of(explanation: object, points: int = 48) -> Mapping[int, tuple[Line, ...]]:  # noqa: ARG001
    """Return lines around people by track id, sampled at this many points; none for an unknown kind.

    A new kind of explanation registers its drawing function for still pictures here.
    """
    return {}


@lines_of.register
def _(explanation: ContourExplanation, points: int = 48) -> Mapping[int, tuple[Line, ...]]:
    return {number: outline(ellipse, points) for number, ellipse in explanation.ellipses.items()}


@lines_of.register
def _(explanation: AttentiveExplanation, points: int = 48) -> Mapping[int, tuple[Line, ...]]:
    return lines_of(explanation.below, points)


Picture = NDArray[np.uint8]  # (H, W, 3) RGB
Plate = tuple[int, int, int, int]  # left, top, right, bottom of a label on the enlarged picture

SCALE = 2

PALETTES = {"grey": None, "inferno": cv2.COLORMAP_INFERNO}

_SUBPIXEL_BITS = 4
_FONT = cv2.FONT_HERSHEY_SIMPLEX
_DASH_PX = 8.0
_EDGE: Rgb = (20, 20, 20)
_UNTURNED = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
_DIM = 0.6  # of a tentative track
_PLATE = 5  # divides the brightness below a label
_TEXT = 0.6  # share of a track's colour in its label, the rest is white: strokes of a pixel look darker
_LEAST_FONT = 0.5  # legible in a picture of half of a page's width
_MOVES = (0, 1, 2, 3, -1, -2, 4, 5)  # rows by which a label is shifted to avoid others
_SHORT = {Status.PARTLY_OCCLUDED: " partly", Status.TOTALLY_OCCLUDED: " hidden"}


class TrueBox(Protocol):
    """The ground truth of a person that is drawn."""

    @property
    def name(self) -> str:
        """Name in the scenario."""
        ...

    @property
    def box(self) -> Box | None:
        """Ground truth box; None behind the camera."""
        ...

    @property
    def visible_fraction(self) -> float:
        """Visible share of the whole silhouette."""
        ...


def enlarge(image: Picture, scale: float = SCALE) -> Picture:
    """Resize an (H, W, 3) image by the factor `scale` with interpolation."""
    way = cv2.INTER_CUBIC if scale > 1 else cv2.INTER_AREA
    return np.asarray(cv2.resize(image, None, fx=scale, fy=scale, interpolation=way), np.uint8)


def show_thermal(thermal: NDArray[np.uint8], palette: str = "grey") -> Picture:
    """Convert an (H, W) thermal image to an RGB picture of the same size, in one of `PALETTES`."""
    colours = PALETTES[palette]
    if colours is None:
        return np.asarray(cv2.cvtColor(thermal, cv2.COLOR_GRAY2RGB), np.uint8)
    return np.asarray(cv2.cvtColor(cv2.applyColorMap(thermal, colours), cv2.COLOR_BGR2RGB), np.uint8)


def show_image(images: Mapping[str, NDArray[Any]], name: str, config: CameraConfig) -> Picture:
    """Convert a camera's image to a picture of the same size, as its kind of camera is displayed."""
    return as_picture(shown_to_people(images, name, config))


def as_picture(shown: NDArray[np.uint8]) -> Picture:
    """Convert (H, W) grey to RGB; return (H, W, 3) RGB as it is."""
    return show_thermal(shown) if shown.ndim == 2 else shown


def encode_jpeg(image: NDArray[np.uint8], quality: int, *, has_own_codes: bool = True) -> bytes:
    """Encode an (H, W) grey or (H, W, 3) RGB image; quality 0..100.

    Optimised Huffman codes make a single image smaller. Many images that are compressed together are smaller
    if they share the standard codes.
    """
    stored = image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_RGB2BGR)
    options = [cv2.IMWRITE_JPEG_QUALITY, quality, cv2.IMWRITE_JPEG_OPTIMIZE, int(has_own_codes)]
    return cv2.imencode(".jpg", stored, options)[1].tobytes()


def encode_png(image: NDArray[np.uint8] | NDArray[np.uint16]) -> bytes:
    """Encode an (H, W) grey image of 8 or 16 bits, or an (H, W, 3) RGB image, fast and lossless."""
    stored = image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_RGB2BGR)
    return cv2.imencode(".png", stored, [cv2.IMWRITE_PNG_COMPRESSION, 1])[1].tobytes()


def draw_tracks(
    picture: Picture,
    tracks: Iterable[Track],
    scale: float = SCALE,
    explanation: object = None,
    affine: Matrix | None = None,
    plates: list[Plate] | None = None,
    camera: str = THERMAL,
) -> Picture:
    """Draw boxes, ids, confidence and status of tracks, and the tracker's explanation of them.

    Tentative tracks are dim and labelled with their id and a question mark.

    Args:
        picture: the camera's image, enlarged `scale` times; it is not modified.
        tracks: the tracks to draw.
        scale: enlargement of the picture.
        explanation: their tracker's explanation; None to draw the boxes alone.
        affine: (2, 3) thermal pixels to the picture's, before enlarging; None for the thermal image itself.
        plates: places of earlier labels, which are avoided; those of new labels are appended.
        camera: the camera whose boxes are drawn; tracks without a box there are omitted.
    """
    canvas, placed = (
        picture.copy(),
        [(track, track.boxes[camera]) for track in tracks if camera in track.boxes],
    )
    taken = [] if plates is None else plates
    mapping = _UNTURNED if affine is None else affine
    body = max(round(scale), 1)
    outlines = lines_of(explanation)
    for track, own_box in placed:
        is_sure = track.status is not Status.TENTATIVE
        colour = track_colour(track.id) if is_sure else faded(track_colour(track.id), _DIM)
        box = map_box(own_box, mapping)
        around = outlines.get(track.id, ())
        lines = [(box_corners(box), 1 if around else body)]
        lines += [(line @ mapping[:, :2].T + mapping[:, 2], body) for line in around]
        # Dark edges keep the lines visible on clothes of the same colour.
        for shade, extra in ((_EDGE, 1), (colour, 0)):
            for line, thickness in lines:
                draw_line(canvas, line, shade, scale, thickness + extra)
    for track, own_box in placed:
        box = map_box(own_box, mapping)
        if _is_inside(box, canvas, scale):
            _label(canvas, _track_text(track), box, track_colour(track.id), scale, taken)
    return canvas


def draw_tracks_of(
    camera: str,
    picture: Picture,
    tracks: Sequence[Track],
    cameras: Mapping[str, CameraConfig],
    scale: float = SCALE,
    explanation: object = None,
    plates: list[Plate] | None = None,
) -> Picture:
    """Draw tracks by their boxes in the image of any camera; other arguments as in `draw_tracks`.

    On the colour image, a track without a box there is drawn by its thermal box. Explanations belong to
    thermal images.
    """
    if camera == "colour" and not any(camera in track.boxes for track in tracks):
        return draw_tracks(picture, tracks, scale, explanation, colour_from_thermal(cameras), plates)
    parts = track_parts(tracks, camera, cameras[camera].camera)
    explained = explanation if camera == THERMAL else None
    return draw_tracks(picture, parts, scale, explained, plates=plates, camera=camera)


def draw_truth(
    picture: Picture,
    people: Iterable[TrueBox],
    scale: float = SCALE,
    affine: Matrix | None = None,
    plates: list[Plate] | None = None,
) -> Picture:
    """Draw ground truth as thin dashed boxes with name and visible share; arguments as in `draw_tracks`."""
    canvas = picture.copy()
    taken = [] if plates is None else plates
    mapping = _UNTURNED if affine is None else affine
    boxes = [(person, map_box(person.box, mapping)) for person in people if person.box is not None]
    shown = [(person, box) for person, box in boxes if _is_inside(box, canvas, scale)]
    for _, box in shown:
        for dash in _dashes(box_corners(box), _DASH_PX / scale):
            draw_line(canvas, dash, TRUTH, scale, thickness=1)
    for plate in taken:  # lines would strike their labels through
        _part(canvas, plate)[:] = _part(picture, plate)
    for person, box in shown:
        text = f"{person.name} {person.visible_fraction:.0%}"
        _label(canvas, text, box, TRUTH, scale, taken, is_below=True)
    return canvas


def map_box(box: Box, affine: Matrix) -> Box:
    """Map a box by a (2, 3) affine; return the upright box around the result if the affine rotates."""
    points = box_corners(box) @ affine[:, :2].T + affine[:, 2]
    (left, top), (right, bottom) = points.min(axis=0), points.max(axis=0)
    return float(left), float(top), float(right - left), float(bottom - top)


def box_parts(box: Box, camera: CameraGeometry) -> tuple[Box, ...]:
    """Split a box across a panorama's seam into its parts at the right and at the left border."""
    around = around_px(camera)
    if math.isinf(around):
        return (box,)
    left, top, width, height = box
    left -= math.floor((left + 0.5) / around) * around
    over = left + width - (around - 0.5)
    whole = (left, top, width, height)
    return (whole,) if over <= 0.0 else ((left, top, width - over, height), (-0.5, top, over, height))


def people_parts(people: Iterable[PersonTruth], camera: CameraGeometry) -> list[PersonTruth]:
    """Return people as they are drawn: a person across the seam twice, each time with one part of the box."""
    return [
        replace(person, box=part)
        for person in people
        if person.box is not None
        for part in box_parts(person.box, camera)
    ]


def track_parts(tracks: Iterable[Track], name: str, camera: CameraGeometry) -> list[Track]:
    """Return the tracks with a box in a camera as they are drawn: split at the seam as in `people_parts`."""
    return [
        replace(track, boxes={**track.boxes, name: part})
        for track in tracks
        if name in track.boxes
        for part in box_parts(track.boxes[name], camera)
    ]


def box_corners(box: Box) -> NDArray[np.float64]:
    """Return the closed line (5, 2) around a box."""
    left, top, right, bottom = corners(box)
    return np.array([[left, top], [right, top], [right, bottom], [left, bottom], [left, top]])


def draw_line(
    canvas: Picture, points: NDArray[np.float64], colour: Rgb, scale: float = 1, thickness: int = 1
) -> None:
    """Draw an antialiased line through points (K, 2) [px] of the image on its enlarged picture, in place."""
    # Pixel (0, 0) spans -0.5..0.5, so its enlarged copy does not start at scale * 0.
    enlarged = (points + 0.5) * scale - 0.5
    fixed = np.round(np.clip(enlarged, -1e4, 1e4) * (1 << _SUBPIXEL_BITS)).astype(np.int32)
    cv2.polylines(canvas, [fixed], False, colour, thickness, cv2.LINE_AA, _SUBPIXEL_BITS)


def _is_inside(box: Box, canvas: Picture, scale: float) -> bool:
    left, top, right, bottom = corners(box)
    rows, columns = canvas.shape[0] / scale, canvas.shape[1] / scale
    return left < columns and top < rows and right > 0.0 and bottom > 0.0


def _track_text(track: Track) -> str:
    if track.status is Status.TENTATIVE:
        return f"{track.id}?"
    return f"{track.id}: {track.confidence:.2f}{_SHORT.get(track.status, '')}"


def _dashes(line: NDArray[np.float64], length: float) -> Iterable[NDArray[np.float64]]:
    for start, end in pairwise(line):
        count = max(int(np.linalg.norm(end - start) / length) // 2 * 2 + 1, 1)
        marks = start + (end - start) * np.linspace(0.0, 1.0, count + 1)[:, None]
        yield from (marks[k : k + 2] for k in range(0, count, 2))


def _label(
    canvas: Picture,
    text: str,
    box: Box,
    colour: Rgb,
    scale: float,
    taken: list[Plate],
    is_below: bool = False,
) -> None:
    """Write a label on a dark plate above or below a box, inside the picture and clear of other plates.

    A label that is moved away from its box gets a line to it.
    """
    # The font grows with the scale, but not beyond what suits the height of the picture.
    size = max(min(0.25 * scale, canvas.shape[0] / 960.0), _LEAST_FONT)
    stroke = max(round(2.0 * size), 1)
    (width, height), descent = cv2.getTextSize(text, _FONT, size, stroke)
    line = height + descent + 3
    left, top = box[0] * scale, box[1] * scale
    bottom = (box[1] + box[3]) * scale + line if is_below else top - descent - 3.0  # clear of the box
    rows, columns = canvas.shape[:2]
    x = round(min(max(left, 2.0), max(columns - width - 2.0, 2.0)))
    places = []
    for move in _MOVES:
        wanted = bottom + (line if is_below else -line) * move
        y = round(min(max(wanted, height + 3.0), rows - descent - 2.0))
        places.append((x - 2, y - height - 2, x + width + 2, y + descent + 1))
    plate = next((place for place in places if not any(_touch(place, other) for other in taken)), places[0])
    taken.append(plate)
    if plate != places[0]:
        _lead(canvas, plate, (x, round(bottom - line if is_below else top)), colour)
    _part(canvas, plate)[:] //= _PLATE
    shade = paled(colour, _TEXT)
    cv2.putText(canvas, text, (x, plate[3] - descent - 1), _FONT, size, shade, stroke, cv2.LINE_AA)


def _part(canvas: Picture, plate: Plate) -> Picture:
    """Return the part of a picture below a plate, as a view."""
    return canvas[max(plate[1], 0) : plate[3], max(plate[0], 0) : plate[2]]


def _lead(canvas: Picture, plate: Plate, corner: tuple[int, int], colour: Rgb) -> None:
    """Draw a line from a label that had to make room to the corner of its box."""
    x, y = corner
    near = plate[3] if plate[3] < y else plate[1] if plate[1] > y else y
    if near != y:
        cv2.line(canvas, (x, y), (x, near), colour, 1, cv2.LINE_AA)


def _touch(one: Plate, other: Plate) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]
