"""Box conventions: around the torso, or around the whole person, as in most annotations and detectors.

Annotators also measure pixels from the corner of the image, whereas PeopleBoy measures from the centre of the
first pixel. Annotated boxes end at the image border, whereas those of PeopleBoy may extend beyond it.
"""

import math
from collections.abc import Iterable, Iterator, Mapping
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
WHOLE_PER_HEIGHT: Final = 0.45
"""The same for annotated people, including arms and legs: chosen by HOTA on camel_08 and camel_21."""
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
    return tuple(replace(track, boxes=dict(_within(track.boxes, frame))) for track in tracks)


def _within(torsos: Mapping[str, Box], frame: Frame) -> Iterator[tuple[str, Box]]:
    for camera, torso in torsos.items():
        box = whole_of(torso)
        if camera in frame.images:
            height_px, width_px = frame.images[camera].shape[:2]
            left, top, width, height = within_image(np.array(box), width_px, height_px).tolist()
            box = (left, top, width, height)
        if min(box[2:]) > 0.0:
            yield camera, box


def whole_of(torso: Box) -> Box:
    """Return a box of a typical whole person's width about the torso box, relative to the image's corner."""
    left, top, width, height = torso
    whole = WHOLE_PER_HEIGHT * height
    return left + (width - whole) / 2.0 + CORNER_PX, top + CORNER_PX, whole, height


def torso_of(whole: Box) -> Box:
    """Return the torso box centred on a whole person's box that is relative to the image's corner."""
    left, top, width, height = whole
    torso = TORSO_PER_HEIGHT * height
    return left + (width - torso) / 2.0 - CORNER_PX, top - CORNER_PX, torso, height
