"""Box conventions: around the torso, or around the whole person, as in most annotations and detectors.

Annotators also measure pixels from the corner of the image, whereas PeopleBoy measures from the centre of the
first pixel. Annotated boxes end at the image border, whereas those of PeopleBoy may extend beyond it.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from enum import StrEnum
from typing import Final

import numpy as np

from peopleboy.tracker.boxes import Box, within_image
from peopleboy.tracker.evaluation.sequence import Rows, TrueBoxes
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.track import Track

TORSO_PER_HEIGHT: Final = 0.22
"""Width of the torso divided by people's height: the median in random worlds."""
WHOLE_PER_HEIGHT: Final = 0.44
"""The same for annotated people, including arms and legs."""
_ABOVE: Final = 0.01
_BELOW: Final = 0.03
"""Margins of annotated boxes above the head and below the feet, in heights of the person."""
_TALLER: Final = 1.0 + _ABOVE + _BELOW
_ASIDE: Final = 0.04
"""The same on the left and right of the detected edges of people."""
# These were chosen on camel_01, 02, 08, 11, 21 and llvip, by HOTA and average precision.
CORNER_PX: Final = 0.5
"""Corner of an image, relative to the middle of its first pixel."""
_WIDEST_TORSO: Final = 0.3  # width divided by height up to which boxes are taken for torso boxes


class BoxKind(StrEnum):
    """Box convention."""

    TORSO = "torso"
    WHOLE = "whole"

    @classmethod
    def of(cls, truth: TrueBoxes) -> "BoxKind":
        """Return the convention of boxes, by their median width; without any, whole people."""
        return cls.TORSO if width_per_height(truth) <= _WIDEST_TORSO else cls.WHOLE


def width_per_height(boxes: Rows) -> float:
    """Return the median ratio of width to height of boxes; NaN without any."""
    is_tall = boxes.box[:, 3] > 0.0
    if not is_tall.any():
        return math.nan
    return float(np.median(boxes.box[is_tall, 2] / boxes.box[is_tall, 3]))


def boxed_whole(tracks: Iterable[Track], frame: Frame) -> tuple[Track, ...]:
    """Return tracks with boxes around the whole person instead of the torso.

    Boxes are clipped to the borders of the frame's images, and dropped outside. Without an image they are not
    clipped.
    """
    return tuple(replace(track, boxes=dict(_within(track, frame))) for track in tracks)


def _within(track: Track, frame: Frame) -> Iterator[tuple[str, Box]]:
    for camera, torso in track.boxes.items():
        box = whole_of(torso, track.edges)
        if camera in frame.images:
            height_px, width_px = frame.images[camera].shape[:2]
            left, top, width, height = within_image(np.array(box), width_px, height_px).tolist()
            box = (left, top, width, height)
        if min(box[2:]) > 0.0:
            yield camera, box


def whole_of(torso: Box, edges: tuple[float, float] | None = None) -> Box:
    """Return an annotator's box about a person with this torso box, relative to the image's corner.

    Args:
        torso: the torso box.
        edges: left and right edge of the person as in `Track`; None for a person of the usual width.
    """
    left, top, width, height = torso
    half = WHOLE_PER_HEIGHT * _TALLER / 2.0
    low, high = (-half, half) if edges is None else (edges[0] - _ASIDE, edges[1] + _ASIDE)
    begin = left + width / 2.0 + low * height + CORNER_PX
    return begin, top - _ABOVE * height + CORNER_PX, (high - low) * height, _TALLER * height


def person_of(whole: Box) -> Box:
    """Return the box of a person without margins, from an annotator's box relative to the image's corner."""
    left, top, width, tall = whole
    height = tall / _TALLER
    aside = _ASIDE * height
    return left + aside - CORNER_PX, top + _ABOVE * height - CORNER_PX, width - 2.0 * aside, height


def torso_of(whole: Box) -> Box:
    """Return the torso box of a person with an annotator's box that is relative to the image's corner."""
    left, top, width, tall = whole
    height = tall / _TALLER
    torso = TORSO_PER_HEIGHT * height
    return left + (width - torso) / 2.0 - CORNER_PX, top + _ABOVE * height - CORNER_PX, torso, height
