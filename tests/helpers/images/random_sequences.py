"""Truth and tracks for tests: drawn by hypothesis, or written out by hand."""

from collections.abc import Iterable

import numpy as np
from hypothesis import strategies as st

from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes

Line = tuple[int, int, float, float, float, float]  # frame, id, left, top, width, height


def truth_of(lines: Iterable[Line], counted: bool | list[bool] = True, visible: float = 1.0) -> TrueBoxes:
    table = np.array(list(lines), dtype=np.float64).reshape(-1, 6)
    return TrueBoxes(
        frame=table[:, 0],
        id=table[:, 1],
        box=table[:, 2:],
        counted=np.broadcast_to(counted, len(table)),
        visible=np.full(len(table), visible),
    )


def tracks_of(lines: Iterable[Line]) -> TrackBoxes:
    table = np.array(list(lines), dtype=np.float64).reshape(-1, 6)
    return TrackBoxes(frame=table[:, 0], id=table[:, 1], box=table[:, 2:], confidence=np.ones(len(table)))


def as_tracks(truth: TrueBoxes) -> TrackBoxes:
    return TrackBoxes(frame=truth.frame, id=truth.id, box=truth.box, confidence=np.ones(len(truth)))


@st.composite
def sequences(draw: st.DrawFn, all_counted: bool = False) -> tuple[TrueBoxes, TrackBoxes]:
    """Crowded people, and tracks that jitter, miss, swap names and see ghosts; boxes never tie exactly."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    people, frames, ghosts = draw(st.integers(0, 4)), draw(st.integers(1, 8)), draw(st.integers(0, 3))
    frame, person = (axis.ravel() for axis in np.mgrid[1 : frames + 1, 0:people])
    start = rng.uniform([0, 20, 20, 60], [80, 40, 40, 120], (people, 4))
    box = start[person] + rng.normal(0.0, 2.0, (len(frame), 4))
    present = rng.random(len(frame)) < draw(st.sampled_from([0.5, 0.9, 1.0]))
    truth = TrueBoxes(
        frame=frame[present],
        id=person[present] * 3 + 1,
        box=box[present],
        counted=(rng.random(len(frame)) < (1.0 if all_counted else 0.7))[present],
        visible=rng.uniform(0.01, 1.0, len(frame))[present],
    )

    jitter = draw(st.sampled_from([0.0, 3.0, 12.0]))
    seen = box + rng.normal(0.0, jitter, box.shape) + rng.uniform(0.0, 1e-6, box.shape)
    swap = rng.integers(1, frames + 2)  # from this frame on, names have moved on by one person
    name = np.where(frame >= swap, (person + 1) % max(people, 1), person)
    found = rng.random(len(frame)) < draw(st.sampled_from([0.6, 0.95, 1.0]))
    ghost_frame, ghost = (axis.ravel() for axis in np.mgrid[1 : frames + 1, 0:ghosts])
    ghost_box = rng.uniform([0, 20, 20, 60], [80, 40, 40, 120], (len(ghost), 4))
    all_boxes = np.concatenate([np.maximum(seen[found], 1.0), ghost_box])
    tracks = TrackBoxes(
        frame=np.concatenate([frame[found], ghost_frame]),
        id=np.concatenate([name[found], ghost + 50]),
        box=all_boxes,
        confidence=rng.random(len(all_boxes)),
    )
    return truth, tracks
