"""Everything that looks on while a run goes: event log, scores of following, contact sheet, recording."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from peopleboy.scenarios.drawing.contact_sheet import ContactSheet
from peopleboy.scenarios.files.scenario_file import FaultSpec
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.loop.run_events import LogLine, RunEvents
from peopleboy.scenarios.recording.recorder import Recorder
from peopleboy.scenarios.scores.comfort_metrics import ComfortLog
from peopleboy.scenarios.scores.corridor_metrics import CorridorLog
from peopleboy.scenarios.scores.following_score import FollowingLog, whose_tracks
from peopleboy.sim.config import WorldConfig
from peopleboy.tracker.footage.box_kinds import BoxKind


class Watchers:
    """Hands each tick to all who look on; a recorder only if there is one.

    Args:
        config: of the world.
        title: of the run.
        recorder: of it, if there is one.
        boxes: what the tracker's boxes are drawn round.
        faults: that the scenario asks for.
        is_secret: whether nobody knows whom the robot goes after, as commands alone do not tell.
    """

    def __init__(
        self,
        config: WorldConfig,
        title: str,
        recorder: Recorder | None,
        boxes: BoxKind = BoxKind.TORSO,
        *,
        faults: Sequence[FaultSpec] = (),
        is_secret: bool = False,
    ) -> None:
        self.following = FollowingLog()
        self.corridor = CorridorLog()
        self.comfort = ComfortLog()
        self._events = RunEvents(faults)
        self._sheet = ContactSheet(title, config.robot)
        self._recorder = recorder
        self._boxes = boxes
        self._is_secret = is_secret
        self._track = 0  # that lay on the person to follow last

    def update(self, tick: Tick) -> list[LogLine]:
        """Look at one tick and return what happened at it."""
        events = self._events.update(tick)
        track, is_wrong = whose_tracks(tick, self._boxes, self._track)
        self._track = track or self._track
        self.following.add(tick.truth, track, None if self._is_secret else is_wrong)
        self.corridor.add(tick.truth)
        self.comfort.add(tick.truth)
        self._sheet.add(tick, events)
        if self._recorder is not None:
            self._recorder.log(tick, events)
        return events

    def save(self, folder: Path) -> None:
        """Save what is drawn at the end."""
        self._sheet.save(folder / "contact_sheet.png")
