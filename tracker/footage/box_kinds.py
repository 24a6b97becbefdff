"""What boxes are drawn round: the torso, as ours are, or all of a person, as annotators and detectors do.

Annotators also count pixels from the image's corner, and ours are counted from the middle of the first one;
theirs end at the image's borders, and ours go on.
"""

from __future__ import annotations

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
"""Width of the torso over people's height: the median of those in random worlds."""
WHOLE_PER_HEIGHT: Final = 0.45
"""The same of people as they are annotated, arms and legs included: by HOTA of camel_08 and camel_21."""
CORNER_PX: Final = 0.5
"""Of an image, from the middle of its first pixel."""
_WIDEST_TORSO: Final = 0.3  # width over height up to which boxes are taken for those of torsos


class BoxKind(StrEnum):
    """What boxes are drawn round."""

    TORSO = "torso"
    WHOLE = "whole"

    @classmethod
    def of(cls, truth: TrueBoxes) -> BoxKind:
        """Return by how wide they are, in the median; without any, people are taken to be boxed whole."""
        return cls.TORSO if width_per_height(truth) <= _WIDEST_TORSO else cls.WHOLE


def width_per_height(boxes: Rows) -> float:
    """Return how wide boxes are for their height, in the median; NaN without any."""
    is_tall = boxes.box[:, 3] > 0.0
    if not is_tall.any():
        return math.nan
    return float(np.median(boxes.box[is_tall, 2] / boxes.box[is_tall, 3]))


def boxed_whole(tracks: Iterable[Track], frame: Frame) -> tuple[Track, ...]:
    """Return tracks with boxes round all of a person, in the place of those round the torso.

    They end at the borders of the frame's images; who is outside an image has no box in it, and where there
    is no image, none is cut off.
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
    """Make a box as wide as people mostly are, about the same middle, and count it from the corner."""
    left, top, width, height = torso
    whole = WHOLE_PER_HEIGHT * height
    return left + (width - whole) / 2.0 + CORNER_PX, top + CORNER_PX, whole, height


def torso_of(whole: Box) -> Box:
    """Make a box that is counted from the corner as wide as torsos mostly are, about the same middle."""
    left, top, width, height = whole
    torso = TORSO_PER_HEIGHT * height
    return left + (width - torso) / 2.0 - CORNER_PX, top - CORNER_PX, torso, height
