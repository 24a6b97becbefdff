"""Count the content of a data set as in the thesis's table 3.1.

A *detection* is a counted person (3..10 m away) who is at least partly visible, in one frame: a target of the
scores. A *track* is a maximal span of frames in which one person is counted and in the image, hidden or not;
gaps of up to `GAP_S`, such as an arm that swings over the border, do not end it. An *occlusion* is a
detection with a hidden share that starts an occlusion in the event log. The thesis does not define the word,
but 1130 occlusions among 42 tracks can only be occluded detections.
"""

from collections.abc import Iterable
from dataclasses import astuple, dataclass, fields

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from peopleboy.scenarios.run_folder.run_tables import is_in_image
from peopleboy.sim.truth.events import OCCLUSION_STARTS
from peopleboy.tracker.evaluation.box_matching import counts

GAP_S = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class Content:
    """One column of the thesis's table 3.1.

    Attributes:
        frames_with_persons: frames with a detection.
        frames: all frames.
        tracks, detections, occlusions: as defined in the module.
        at_once: maximum number of detections in a frame.
    """

    frames_with_persons: int
    frames: int
    tracks: int
    detections: int
    occlusions: int
    at_once: int


# Thesis, table 3.1; it counts no occlusions of single persons.
THESIS = {
    "dataset1": Content(
        frames_with_persons=590, frames=1268, tracks=8, detections=590, occlusions=0, at_once=1
    ),
    "dataset2": Content(
        frames_with_persons=8431, frames=14573, tracks=45, detections=8431, occlusions=0, at_once=1
    ),
    "dataset3": Content(
        frames_with_persons=3476, frames=4369, tracks=42, detections=6425, occlusions=1130, at_once=3
    ),
    "dataset4": Content(
        frames_with_persons=2131, frames=2400, tracks=11, detections=3831, occlusions=159, at_once=4
    ),
}


def count(people: pa.Table, frames: int, rate_hz: float) -> Content:
    """Count the content of one run.

    Args:
        people: its ground truth, as `peopleboy.scenarios.run_folder.run_tables.TRUTH`.
        frames: number of frames.
        rate_hz: frames per second.
    """
    frame, person = people["frame"].to_numpy(), people["id"].to_numpy()
    counted = people["is_counted"].to_numpy(zero_copy_only=False)
    seen = counts(counted, people["visible_fraction"].to_numpy())
    hidden = seen & (people["occluded_fraction"].to_numpy() > OCCLUSION_STARTS)
    present = counted & is_in_image(people)
    _, at_once = np.unique(frame[seen], return_counts=True)
    gap = round(GAP_S * rate_hz)
    return Content(
        frames_with_persons=len(at_once),
        frames=frames,
        tracks=sum(_runs(frame[present & (person == who)], gap) for who in np.unique(person)),
        detections=int(seen.sum()),
        occlusions=int(hidden.sum()),
        at_once=int(at_once.max(initial=0)),
    )


def add_up(contents: Iterable[Content]) -> Content:
    """Combine runs: sums, and for `at_once` the maximum."""
    rows = np.array([astuple(content) for content in contents])
    totals = [*rows[:, :-1].sum(axis=0), rows[:, -1].max()]
    return Content(**{field.name: int(total) for field, total in zip(fields(Content), totals, strict=True)})


def _runs(frames: NDArray[np.int64], gap: int) -> int:
    """Count maximal spans of ascending frames, in which gaps of up to `gap` frames are allowed."""
    return int((np.diff(frames) > gap + 1).sum()) + 1 if len(frames) else 0
