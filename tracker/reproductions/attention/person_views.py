"""Views of a tracked person in the colour cameras."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.tracker.frame import COLOUR, DEPTH, DEPTH_COLOUR, PANORAMA, THERMAL, Frame
from peopleboy.tracker.reproductions.contour.box_interaction import places_on_floor
from peopleboy.tracker.track import Box, FloorPlace, Status, Track

LOOKED_AT: Final = (COLOUR, DEPTH_COLOUR, PANORAMA)
"""Names of the cameras with colours."""

_SAME_LENS: Final = {DEPTH_COLOUR: DEPTH}
_TALL_M: Final = 1.72
_WIDTH: Final = 0.3  # of a box of unknown width, in its heights
_NEAREST_M: Final = 0.3


@dataclass(frozen=True, slots=True, eq=False)
class PersonView:
    """A person in the image of one camera.

    Attributes:
        camera: its name.
        image: (H, W, 3) RGB.
        box: left, top, width, height [px] from head to feet.
    """

    camera: str
    image: NDArray[np.uint8]
    box: Box


def views_of(track: Track, frame: Frame) -> Iterator[PersonView]:
    """Return a tracked person's view in each available colour image.

    Raises:
        BadInput: an image is invalid.
    """
    for camera in LOOKED_AT:
        if camera in frame.images:
            box = box_in(camera, track, frame)
            if box is not None:
                yield PersonView(camera, frame.rgb(camera), box)


def check_colours(frame: Frame) -> None:
    """Refuse frames of a robot without a colour camera.

    Raises:
        BadInput: no camera, now or at other instants, has colours.
    """
    if not any(camera in frame.images or camera in frame.calibrations for camera in LOOKED_AT):
        known = ", ".join(frame.images) or "none"
        raise BadInput(f"attention needs a colour camera, {' or '.join(LOOKED_AT)}; the robot has {known}")


def box_in(camera: str, track: Track, frame: Frame) -> Box | None:
    """Return a track's box in a colour image: its own, or projected from its direction or position.

    A track with a thermal box but no position is placed where a person of usual height would stand. Without
    calibrations the colour image is assumed to be aligned with the thermal image.

    Returns:
        left, top, width, height [px]; it may lie outside; None if unknown.
    """
    for name in (camera, _SAME_LENS.get(camera, camera)):
        if name in track.boxes:
            return track.boxes[name]
    calibration, thermal = frame.calibrations.get(camera), frame.calibrations.get(THERMAL)
    if calibration is None:
        return _same_view(camera, track, frame)
    place = track.place or _place_by_height(track, thermal)
    if place is None:
        return None
    ahead, aside = place.position_m
    if THERMAL in track.boxes and thermal is not None:
        ends = _ends(track.boxes[THERMAL], ahead, thermal)
    else:
        ends = np.array([[ahead, aside, _TALL_M], [ahead, aside, 0.0]])
    return None if ends is None else _between(calibration.project(ends))


def _same_view(camera: str, track: Track, frame: Frame) -> Box | None:
    if THERMAL not in track.boxes or THERMAL not in frame.images:
        return None
    here, there = frame.images[camera].shape, frame.images[THERMAL].shape
    across, down = here[1] / there[1], here[0] / there[0]
    left, top, width, height = track.boxes[THERMAL]
    return left * across, top * down, width * across, height * down


def _place_by_height(track: Track, thermal: Calibration | None) -> FloorPlace | None:
    """Return the position of a person for whom a tracker has only a thermal box."""
    if thermal is None or THERMAL not in track.boxes:
        return None
    return places_on_floor([track.boxes[THERMAL]], [Status.TRACKED], thermal)[0]


def _ends(box: Box, ahead_m: float, thermal: Calibration) -> NDArray[np.float64] | None:
    """Return the points (2, 3) [m] of head and feet at a given distance ahead of the robot, from a box."""
    left, top, width, height = box
    rays = thermal.rays(np.array([[left + width / 2.0, top], [left + width / 2.0, top + height]]))
    away_m = ahead_m - thermal.position_m[0]
    if away_m < _NEAREST_M or rays[:, 0].min() <= 0.0:
        return None
    return np.asarray(thermal.position_m + rays * (away_m / rays[:, :1]), np.float64)


def _between(ends: NDArray[np.float64]) -> Box | None:
    (u, top), (low_u, bottom) = ends.tolist()
    height = bottom - top
    if not height > 1.0 or not abs(low_u - u) < height:
        return None
    return u - _WIDTH * height / 2.0, top, _WIDTH * height, height
