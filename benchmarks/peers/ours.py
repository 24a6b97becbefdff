"""PeopleBoy's trackers for comparisons; they need no other packages."""

from typing import Protocol

import numpy as np

from benchmarks.peers.detectors import Boxes
from peopleboy.tracker.footage.box_kinds import boxed_whole
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.track import confirmed
from peopleboy.tracker.trackers import make_tracker


class Contestant(Protocol):
    """Interface of compared trackers: frames in, boxes with ids out."""

    def step(self, frame: Frame) -> tuple[Boxes, list[int]]:
        """Return boxes (N, 4) of the next frame, left, top, width, height [px], and their ids."""
        ...


class Ours:
    """A tracker of `peopleboy.tracker.trackers`."""

    def __init__(self, name: str, seed: int, *, boxes_whole: bool = False) -> None:
        self._tracker = make_tracker(name, seed)
        self._boxes_whole = boxes_whole

    @property
    def cameras(self) -> tuple[str, ...]:
        """Names of the required cameras."""
        return self._tracker.cameras

    def step(self, frame: Frame) -> tuple[Boxes, list[int]]:
        """Update the tracker, and return the confirmed tracks."""
        tracks = self._tracker.update(frame)
        found = list(confirmed(boxed_whole(tracks, frame) if self._boxes_whole else tracks, THERMAL))
        return np.array([box for _, box in found]).reshape(-1, 4), [track.id for track, _ in found]
