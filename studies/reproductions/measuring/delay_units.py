"""How many frames a tracker needs until it has found somebody who is in plain view."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from peopleboy.scenarios.running.engine.store import Result
from peopleboy.scenarios.running.frame_cache import film, frames_of
from peopleboy.sim.random_streams import stream
from peopleboy.studies.reproductions.measuring.units import Showing
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.evaluation.box_matching import GATE
from peopleboy.tracker.evaluation.sequence import TrueBoxes
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import confirmed
from peopleboy.tracker.trackers import Tracker

PATIENCE = 30  # frames after which a tracker has not found the person
EVERY = 15  # frames between two starts
PLAIN = 0.9  # visible fraction from which a person is in plain view


@dataclass(frozen=True, slots=True, eq=False)
class DelayUnit(Showing):
    """Switch a tracker on many times in one film, each time while somebody is in plain view."""

    @property
    def key(self) -> str:
        """What is shown to whom."""
        return f"delay {self.parts}"

    def run(self) -> Result:
        """Count the starts, and the frames of each that found the person, the one of the start included."""
        shot = film(self.play.scenario, self.play.seed, self.cache)
        truth = shot.truth()
        starts = set(plain_starts(truth))
        boxes = dict(zip(truth.frame.tolist(), truth.box, strict=True))
        rng = stream(self.repeat, "reproduce.delay")
        waiting: list[tuple[int, Tracker]] = []
        needed: list[int] = []
        cameras = self.setting.make(rng).cameras
        for number, frame in enumerate(frames_of(shot, cameras), 1):
            if number in starts:
                waiting.append((number, self.setting.make(rng)))
            for start, tracker in list(waiting):
                said = [box for _, box in confirmed(tracker.update(frame), THERMAL)]
                if said and iou(boxes[number][None], np.array(said)).max() > GATE:
                    needed.append(number - start + 1)
                    waiting.remove((start, tracker))
            waiting = [(start, tracker) for start, tracker in waiting if number - start + 1 < PATIENCE]
        return {"starts": len(starts), "needed": needed}


def plain_starts(truth: TrueBoxes) -> Iterator[int]:
    """Give frames from which on exactly one person is there, counted and in plain view, for long enough."""
    people = np.bincount(truth.frame, minlength=truth.last_frame + 1)
    plain = np.bincount(truth.frame[truth.counted & (truth.visible > PLAIN)], minlength=len(people))
    is_plain = (people == 1) & (plain == 1)
    following = 0
    for start in range(1, len(is_plain) - PATIENCE + 1):
        if start >= following and is_plain[start : start + PATIENCE].all():
            yield start
            following = start + EVERY
