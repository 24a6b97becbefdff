"""The tracks that the people tracker outputs, with their boxes and places."""

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from peopleboy.tracker.boxes import iou
from peopleboy.tracker.track import Box, FloorPlace, Track, TrackPosture
from peopleboy.tracker.tracking.motion_filter import Floats, floor_positions
from peopleboy.tracker.tracking.sensor import ProjectedBoxes
from peopleboy.tracker.tracking.track_state import TrackState
from peopleboy.tracker.tracking.tracks import Tracks


def output_tracks(
    tracks: Tracks, images: Mapping[str, ProjectedBoxes], time_s: float, shown: float
) -> tuple[Track, ...]:
    """Return the tracks to output, in order of their ids.

    Args:
        tracks: the K tracks.
        images: their predicted boxes by camera.
        time_s: [s] time of the frame.
        shown: weight of a detected box against the predicted one.
    """
    overlaps = _overlaps_with_seen(tracks, images.values(), time_s)
    places: Sequence[FloorPlace | None] = [None] * len(tracks.items)
    if tracks.origin_m is not None:
        common_m = np.array([one.common_m for one in tracks.items]).reshape(-1, 2)
        places = floor_positions(tracks.states, common_m, tracks.origin_m)
    output = [
        Track(
            id=one.id,
            boxes=_boxes(one, row, images, time_s, shown),
            place=places[row],
            confidence=one.confidence,
            status=one.status(time_s),
            age_s=time_s - one.born_s,
            occluder=one.occluder,
            edges=None if np.isnan(one.edges).any() else (float(one.edges[0]), float(one.edges[1])),
            posture=None if one.posture is None else list(TrackPosture)[int(one.posture.argmax())],
        )
        for row, one in enumerate(tracks.items)
        if one.is_output(time_s, overlaps[row]) and any(image.is_inside[row] for image in images.values())
    ]
    return tuple(sorted(output, key=lambda track: track.id))


def _overlaps_with_seen(tracks: Tracks, images: Collection[ProjectedBoxes], time_s: float) -> Floats:
    """Return the greatest overlap (K,) of each track with one that is seen now, over all images."""
    is_seen = np.array([one.seen_s >= time_s for one in tracks.items], np.bool_)
    overlaps = np.zeros(len(tracks.items))
    for image in images if is_seen.any() else ():
        mutual = iou(image.boxes[:, None], image.boxes[None, is_seen])
        overlaps = np.maximum(overlaps, mutual.max(axis=1))
    return overlaps


def _boxes(
    one: TrackState, row: int, images: Mapping[str, ProjectedBoxes], time_s: float, shown: float
) -> dict[str, Box]:
    """Return the boxes of a track: a blend of the prediction and the detected box, if there is one."""
    boxes = {}
    for camera, image in images.items():
        if image.is_scan or not image.is_inside[row]:
            continue
        box = image.boxes[row]
        seen_s, detected = one.shown.get(camera, (-np.inf, box))
        if seen_s == time_s:
            box = box + shown * (detected - box)
        left, top, width, height = box.tolist()
        boxes[camera] = (left, top, width, height)
    return boxes
