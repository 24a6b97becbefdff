"""Units of work: each is a value that any process can run, and its result is plain data."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, fields, is_dataclass
from itertools import islice
from pathlib import Path
from typing import Any, Final, Literal, Protocol, TypeVar, get_type_hints

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.files.suite import SuiteRun
from peopleboy.scenarios.running.engine.store import Result
from peopleboy.scenarios.running.frame_cache import Film, film, frames_of
from peopleboy.scenarios.scores.suite_table import count
from peopleboy.sim.random_streams import stream
from peopleboy.sim.truth.truth import COUNTED_FARTHEST_M, COUNTED_NEAREST_M
from peopleboy.studies.reproductions.measuring.tracker_settings import Setting
from peopleboy.tracker.evaluation.area_metrics import PaperMetrics, ThesisMetrics
from peopleboy.tracker.evaluation.box_matching import Rule
from peopleboy.tracker.evaluation.evaluate import Counts, evaluate
from peopleboy.tracker.evaluation.mot_metrics import Sums
from peopleboy.tracker.evaluation.sequence import TrackBoxes
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.track import Track, confirmed
from peopleboy.tracker.trackers import Tracker

Count = Literal["ignore", "absent", "own range", "half in view"]
"""Ways to deal with people whom the sources do not count.

The first two are rules of the evaluation. "own range": they are absent, and the tracker tells of nobody whom
it places itself where they are. "half in view": ignored, and so is who is less than half in view.
"""

_HALF: Final = 0.5
RECORDS: dict[str, type[Sums]] = {"counts": Counts, "thesis": ThesisMetrics, "paper": PaperMetrics}

Record = TypeVar("Record", bound=Sums)


class Unit(Protocol):
    """A piece of work."""

    @property
    def key(self) -> str:
        """What it is, in one line; no two units have the same."""
        ...

    @property
    def is_timing(self) -> bool:
        """Whether it measures time, and has to run alone."""
        ...

    def run(self) -> Result:
        """Do the work and give plain data."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class FilmUnit:
    """Render a run's frames into the cache, and count what they hold."""

    play: SuiteRun
    cache: Path
    is_timing: bool = False

    @property
    def key(self) -> str:
        """The film's name."""
        return f"film {play_key(self.play)}"

    def run(self) -> Result:
        """Render, unless it is there, and count as in the thesis's table 3.1."""
        shot = film(self.play.scenario, self.play.seed, self.cache)
        return asdict(count(shot.people(), shot.frames, _rate_hz(shot)))


@dataclass(frozen=True, slots=True, eq=False)
class Showing:
    """One film that one tracker, with one stream of random numbers, is to see.

    Attributes:
        play: what is on the film.
        cache: where films are; it is rendered if it is not there.
        setting: the tracker.
        repeat: number of the random stream, from 0.
    """

    play: SuiteRun
    cache: Path
    setting: Setting
    repeat: int
    is_timing: bool = False

    @property
    def parts(self) -> str:
        """Film, tracker and repeat."""
        return f"{play_key(self.play)} | {self.setting.key} | {self.repeat}"


@dataclass(frozen=True, slots=True, eq=False)
class TrackUnit(Showing):
    """Let a tracker see a film, and score what it finds."""

    @property
    def key(self) -> str:
        """What is shown to whom."""
        return f"track {self.parts}"

    def run(self) -> Result:
        """Track, and score by both rules for people who are not counted."""
        shot = film(self.play.scenario, self.play.seed, self.cache)
        found, is_in_range = track_film(shot, self.setting.make(stream(self.repeat, "reproduce.tracker")))
        ways: dict[Count, tuple[TrackBoxes, Rule, float]] = {
            "ignore": (found, "ignore", 0.0),
            "absent": (found, "absent", 0.0),
            "own range": (found.take(is_in_range), "absent", 0.0),
            "half in view": (found, "ignore", _HALF),
        }
        result: Result = {"frames": shot.frames}
        for name, (tracks, rule, visible) in ways.items():
            scores = evaluate(shot.truth(), tracks, frames=shot.frames, uncounted=rule, min_visible=visible)
            result[name] = {record: asdict(getattr(scores, record)) for record in RECORDS}
        return result


def play_key(play: SuiteRun) -> str:
    """Name a run with its length, which is cut where there is little time."""
    return f"{play.name} {play.scenario.duration_s:g}s"


def track_film(shot: Film, tracker: Tracker) -> tuple[TrackBoxes, NDArray[np.bool_]]:
    """Let a tracker see a film; who is only tentative is not yet claimed.

    Returns:
        What it found, and (N,) whether the tracker itself places it where the sources count people.
    """
    rows = [
        (number, track.id, box, track.confidence, _is_in_range(track, frame))
        for number, frame in enumerate(frames_of(shot, tracker.cameras), 1)
        for track, box in confirmed(tracker.update(frame), THERMAL)
    ]
    frame, identity, box, confidence, is_in_range = zip(*rows, strict=True) if rows else ((), (), (), (), ())
    found = TrackBoxes(
        frame=np.array(frame, dtype=np.int64),
        id=np.array(identity, dtype=np.int64),
        box=np.array(box, dtype=np.float64).reshape(-1, 4),
        confidence=np.array(confidence, dtype=np.float64),
    )
    return found, np.array(is_in_range, dtype=np.bool_)


def _is_in_range(track: Track, frame: Frame) -> bool:
    if track.place is None:
        return True
    x, y, _ = frame.calibrations[THERMAL].position_m
    distance_m = math.hypot(track.place.position_m[0] - x, track.place.position_m[1] - y)
    return COUNTED_NEAREST_M <= distance_m <= COUNTED_FARTHEST_M


def restored(kind: type[Record], data: dict[str, Any]) -> Record:
    """Make a record of sums out of the plain data that `asdict` made of it."""
    hints = get_type_hints(kind)
    nested = {
        field.name: restored(hints[field.name], data[field.name])
        for field in fields(kind)
        if is_dataclass(hints[field.name])
    }
    return kind(**(data | nested))


def _rate_hz(shot: Film) -> float:
    times = [frame.time_s for frame in islice(frames_of(shot, ()), 2)]
    return 1.0 / (times[1] - times[0]) if len(times) == 2 else 15.0
