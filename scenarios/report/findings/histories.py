"""Build the history of each person in a run, frame by frame: visibility and track."""

from collections import Counter
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.finished_run import FinishedRun, cameras_of
from peopleboy.scenarios.run_folder.run_files import (
    RunFiles,
    as_squares,
    is_on_floor_alone,
    read_table,
    truth_files,
)
from peopleboy.scenarios.run_folder.run_tables import TRUTH
from peopleboy.scenarios.scores.evaluate_runs import (
    BoxReference,
    boxed_cameras,
    kind_of_boxes,
    own_camera,
    read_reference_boxes,
)
from peopleboy.sim.cameras.camera_config import CameraConfig, ThermalConfig
from peopleboy.sim.truth.events import (
    LEAVES_INSIDE,
    OCCLUSION_ENDS,
    OCCLUSION_STARTS,
    TOTAL_ENDS,
    TOTAL_STARTS,
)
from peopleboy.sim.truth.truth import BORDER, counted_m
from peopleboy.tracker.evaluation.box_matching import associate, pair_up
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.tracker.frame import THERMAL

# Spans of equal values in columns with one value per frame.

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Span:
    """Frames from `start` up to, but not including, `end`, counted from 0, with one value."""

    value: int
    start: int
    end: int

    @property
    def length(self) -> int:
        """Number of frames."""
        return self.end - self.start


def spans(values: Ints | Flags) -> list[Span]:
    """Split a column (F,) into its maximal spans of one value, in order."""
    if len(values) == 0:
        return []
    edges = [0, *(np.flatnonzero(np.diff(values.astype(np.int64))) + 1).tolist(), len(values)]
    return [Span(int(values[a]), a, b) for a, b in pairwise(edges)]


def settle(values: Ints, shortest: int) -> Ints:
    """Close gaps in a column (F,) shorter than `shortest`, then set shorter spans to 0.

    Every span of a value other than 0 in the result has at least `shortest` frames.
    """
    settled = values.copy()
    for value in np.unique(values[values != 0]):
        at = np.flatnonzero(values == value)
        for before, after in pairwise(at.tolist()):
            if after - before <= shortest:
                settled[before:after] = value
    for span in spans(settled):
        if span.length < shortest:
            settled[span.start : span.end] = 0
    return settled


def between(values: Floats, starts: float, ends: float) -> Flags:
    """Return (F,) where a column has risen above `starts` and not yet fallen below `ends`; NaN resets it."""
    inside = np.zeros(len(values), np.bool_)
    is_in = False
    for k, value in enumerate(values.tolist()):
        is_in = value >= ends if is_in else value > starts
        inside[k] = is_in
    return inside


STEADY_S = 0.3  # a track that is on a person for a shorter time is ignored
_BOX = ("left_px", "top_px", "width_px", "height_px")
_PEOPLE = (
    *("frame", "id", "name", "x_m", "y_m", "distance_m", "is_counted", *_BOX, "whole_px"),
    *("visible_fraction", "occluded_fraction", "occluder", "hidden_by"),
)
_ROBOT = ("frame", "x_m", "y_m", "heading_rad", "mode")


class Visibility(IntEnum):
    """Visibility of a person."""

    AWAY = 0
    SEEN = 1
    PARTLY = 2
    WHOLLY = 3


class TrackingState(IntEnum):
    """State of a person's track."""

    NOT_DUE = 0  # absent, wholly hidden, too near or too far away
    ON = 1
    ADRIFT = 2  # the person's track exists, but its box is not on the person
    MISSED = 3


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PersonHistory:
    """One person in one run; all columns have F rows, one per frame."""

    id: int
    name: str
    position_m: Floats  # (F, 2) world frame; NaN where the person is not present
    distance_m: Floats  # from the camera; NaN as above
    visible: Floats  # share of the whole silhouette; 0 as above
    occluded: Floats  # share hidden of what lies inside the image; NaN outside it
    hider: tuple[str, ...]  # main occluder, a person or an object; empty for none
    is_counted: Flags  # neither too near nor too far away
    view: Ints  # `Visibility`, with the thresholds of the event log
    matched: Ints  # number of the track whose box is on the person (IoU above 0.5), or 0
    track: Ints  # the same without short spans and short gaps
    iou: Floats  # of that box; NaN without one
    offset_px: Floats  # distance of its centre from that of the ground truth; NaN as above
    state: Ints  # `TrackingState`

    @property
    def is_due(self) -> Flags:
        """Whether the person is counted and visible: (F,)."""
        return _is_due(self.is_counted, self.view)

    def hider_in(self, start: int, end: int) -> str:
        """Return the most frequent occluder in some frames; empty for none."""
        names = Counter(name for name in self.hider[max(start, 0) : end] if name)
        return names.most_common(1)[0][0] if names else ""


@dataclass(frozen=True, kw_only=True, eq=False)
class RunHistory:
    """A run, its tables as far as they are needed, and the histories of all people."""

    run: FinishedRun
    files: RunFiles

    @property
    def steady(self) -> int:
        """Number of frames in `STEADY_S`."""
        return max(round(STEADY_S * self.run.rate_hz), 1)

    @cached_property
    def shown(self) -> dict[int, Flags]:
        """For each confirmed track, the frames (F,) in which it is shown.

        Tracks that exist only at frames with an image, as imported ones do, are shown until the next image.
        """
        frames, (_, tracks) = np.arange(self.run.frames), self.boxes
        at = self.newest if np.isin(tracks.frame - 1, self.newest).all() else frames
        return {n: np.isin(at + 1, tracks.frame[tracks.id == n]) for n in np.unique(tracks.id).tolist()}

    @cached_property
    def is_on_floor(self) -> bool:
        """Whether the tracker has positions on the floor, but no boxes."""
        return is_on_floor_alone(self.files.beliefs)

    @cached_property
    def yardstick(self) -> BoxReference:
        """Ground truth boxes to compare with, as in the scores of the run."""
        about, camera = self.run.about, own_camera(self.run.folder)
        tracker = None if about.adopted else about.tracker
        return BoxReference(camera, kind_of_boxes(self.run.folder, camera, tracker, BoxKind(about.boxes)))

    @cached_property
    def camera(self) -> str:
        """The camera that determines visibility; a camera with boxes if the run is scored on the floor."""
        if self.is_on_floor:
            return (*boxed_cameras(self.run.folder), THERMAL)[0]
        return self.yardstick.camera

    @cached_property
    def view(self) -> CameraConfig:
        """Settings of that camera; the default ones of `thermal` if the scenario is unreadable."""
        try:
            return cameras_of(self.run.folder)[self.camera]
        except BadInput:
            if self.camera != THERMAL:
                raise
            return ThermalConfig()

    @property
    def newest(self) -> Ints:
        """For each frame (F,), the frame, from 0, of that camera's newest image."""
        frames = np.arange(self.run.frames)
        return frames - frames % self.every

    @property
    def every(self) -> int:
        """Number of frames from one image of that camera to the next."""
        return self.run.rate_hz // (self.view.rate_hz or self.run.rate_hz)

    @cached_property
    def counted_m(self) -> tuple[float, float]:
        """Minimum and maximum distance [m] from that camera at which people are counted."""
        return counted_m(self.view.camera)

    @cached_property
    def seen(self) -> pa.Table:
        """Ground truth of people in that camera's images."""
        if self.camera == THERMAL:
            return self.files.people
        _, table = truth_files(self.run.folder, self.camera)
        return read_table(table, TRUTH, _PEOPLE)

    @cached_property
    def boxes(self) -> tuple[TrueBoxes, TrackBoxes]:
        """Boxes to match: in that camera's image, or squares on the floor for a tracker without boxes."""
        files = self.files
        if self.is_on_floor:
            return as_squares(self.run.folder, files.people, files.beliefs, files.robot)
        if self.yardstick == BoxReference():
            return files.truth, files.tracks
        return read_reference_boxes(self.run.folder, self.yardstick)

    @cached_property
    def people(self) -> tuple[PersonHistory, ...]:
        """Histories of all people, in the scenario's order."""
        lying = _match_boxes(*self.boxes)
        if self.is_on_floor:
            lying.offset[:] = np.nan  # positions on the floor have no offset in pixels
        return tuple(_person_history(self, who, lying) for who in np.unique(self.seen["id"]).tolist())

    def called(self, name: str) -> PersonHistory:
        """Return the history of a person by name."""
        return next(person for person in self.people if person.name == name)


def read_files(run: FinishedRun) -> RunFiles:
    """Read the tables of a run that histories need.

    Raises:
        BadInput: a table is missing or unreadable.
    """
    return run.files(_PEOPLE, _ROBOT)


def _match_boxes(truth: TrueBoxes, tracks: TrackBoxes) -> Any:
    """Return tracks assigned to people: records of frame (from 0), person, number, iou, offset [px]."""
    pairs = pair_up(truth, tracks)
    chosen = associate(pairs)
    target, candidate = pairs.target[chosen], pairs.candidate[chosen]
    true, given = truth.box[target], tracks.box[candidate]
    offset = np.hypot(*(true[:, :2] + true[:, 2:] / 2.0 - given[:, :2] - given[:, 2:] / 2.0).T)
    columns = (truth.frame[target] - 1, truth.id[target], tracks.id[candidate])
    return np.rec.fromarrays(
        [*columns, pairs.iou[chosen], offset],
        dtype=[("frame", int), ("person", int), ("number", int), ("iou", float), ("offset", float)],
    )


def _person_history(history: RunHistory, person: int, lying: Any) -> PersonHistory:
    frames, people = history.run.frames, history.seen
    rows = people.filter(np.asarray(people["id"].to_numpy() == person))
    at = rows["frame"].to_numpy() - 1
    mine = lying[lying.person == person]

    newest = history.newest

    def spread(values: object, at: Ints = at) -> Floats:
        """Return values for all frames (F,) from the camera's newest image; NaN elsewhere."""
        column = np.full(frames, np.nan)
        column[at] = values
        return np.asarray(column[newest])

    beyond = [dict(hidden).get(BORDER, 0.0) for hidden in rows["hidden_by"].to_pylist()]
    inside = spread((rows["whole_px"].to_numpy() > 0) * (1.0 - np.array(beyond)))
    occluded = spread(rows["occluded_fraction"].to_numpy())
    is_counted = spread(rows["is_counted"].to_numpy(zero_copy_only=False)) > 0.0
    hider = dict(zip(at.tolist(), rows["occluder"].to_pylist(), strict=True))
    view = _view(occluded, ~(inside < LEAVES_INSIDE) & np.isfinite(inside))
    matched = np.nan_to_num(spread(mine.number, mine.frame)).astype(np.int64)
    track = settle(matched, history.steady)
    return PersonHistory(
        id=person,
        name=rows["name"][0].as_py(),
        position_m=np.stack([spread(rows[key].to_numpy()) for key in ("x_m", "y_m")], axis=1),
        distance_m=spread(rows["distance_m"].to_numpy()),
        visible=np.nan_to_num(spread(rows["visible_fraction"].to_numpy())),
        occluded=occluded,
        hider=tuple(hider.get(frame) or "" for frame in newest.tolist()),
        is_counted=is_counted,
        view=view,
        matched=matched,
        track=track,
        iou=spread(mine.iou, mine.frame),
        offset_px=spread(mine.offset, mine.frame),
        state=_state(track, _is_due(is_counted, view), history.shown),
    )


def _is_due(is_counted: Flags, view: Ints) -> Flags:
    return np.asarray(is_counted & np.isin(view, (Visibility.SEEN, Visibility.PARTLY)))


def _view(occluded: Floats, is_inside: Flags) -> Ints:
    hidden = np.where(is_inside, occluded, np.nan)
    view = np.where(is_inside, Visibility.SEEN, Visibility.AWAY)
    view[between(hidden, OCCLUSION_STARTS, OCCLUSION_ENDS)] = Visibility.PARTLY
    view[between(hidden, TOTAL_STARTS, TOTAL_ENDS)] = Visibility.WHOLLY
    return np.asarray(view, np.int64)


def _state(track: Ints, is_due: Flags, shown: dict[int, Flags]) -> Ints:
    """Return the tracking states; a person's number is the last one that was on the person."""
    state = np.zeros(len(track), np.int64)
    last = 0
    for k, number in enumerate(track.tolist()):
        last = number or last
        if number:
            state[k] = TrackingState.ON
        elif is_due[k]:
            state[k] = TrackingState.ADRIFT if last and shown[last][k] else TrackingState.MISSED
    return state
