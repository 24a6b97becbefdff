"""Recorded sequences: what trackers see and what is true, and tracks as they are scored."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import click

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.loop import closed_loop
from peopleboy.sim.truth.truth import Truth
from peopleboy.sim.world import World
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
from peopleboy.tracker.footage.box_kinds import boxed_whole
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.track import Track, confirmed
from peopleboy.tracker.trackers import CONTOUR_TRACKER, make_tracker

TruthRow = tuple[int, int, Sequence[float], bool, float]


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """A recorded sequence.

    Attributes:
        frames: what a tracker sees.
        truth: the boxes of everybody.
        boxes_whole: whether those are of whole people.
    """

    frames: tuple[Frame, ...]
    truth: TrueBoxes
    boxes_whole: bool = False

    def uncalibrated(self) -> "Recording":
        """Return the same, with nothing known of the cameras."""
        return replace(self, frames=tuple(replace(frame, calibrations={}) for frame in self.frames))

    def score(self, tracks: Iterable[Sequence[Track]], min_visible: float = 0.0) -> Scores:
        """Score the tracks of each frame, by those of whom more than a share is visible."""
        if self.boxes_whole:
            tracks = (boxed_whole(each, frame) for each, frame in zip(tracks, self.frames, strict=True))
        found = confirmed_boxes(tracks)
        return evaluate(self.truth, found, frames=len(self.frames), min_visible=min_visible)


def record(scenario: str | Scenario, seed: int) -> Recording:
    """Run a scenario in the closed loop, driven by the contour tracker, and keep what that saw."""
    loaded = load_scenario(scenario) if isinstance(scenario, str) else scenario
    config = loaded.world(seed)
    frames, rows, before = [], [], None
    with World(config) as world:
        count = round(loaded.duration_s * config.control_hz)
        tracker = make_tracker(CONTOUR_TRACKER, seed)
        for tick in closed_loop(world, tracker, loaded.make_behaviour(), count):
            frames.append(Frame.from_observation(tick.observation, before))
            before = tick.observation.odometry
            rows += truth_rows(tick.frame, tick.truth)
    return Recording(tuple(frames), TrueBoxes.from_rows(rows))


def truth_rows(frame: int, truth: Truth) -> list[TruthRow]:
    """Return frame, id, box, whether it counts, and visible share of everybody who has a box."""
    return [
        (frame, person.id, person.box, person.is_counted, person.visible_fraction)
        for person in truth.people
        if person.box is not None
    ]


def confirmed_boxes(frames: Iterable[Iterable[Track]]) -> TrackBoxes:
    """Take the boxes of confirmed tracks in the thermal image, frame by frame, the first one being 1."""
    return TrackBoxes.from_rows(
        (number, track.id, box, track.confidence)
        for number, tracks in enumerate(frames, start=1)
        for track, box in confirmed(tracks, THERMAL)
    )


def print_row(name: str, cells: Sequence[str]) -> None:
    """Print one line of a Markdown table, so that each is there as soon as it is known."""
    click.echo(f"| {' | '.join((name, *cells))} |")


def print_head(name: str, columns: Sequence[str], ruler: Sequence[str] | None = None) -> None:
    """Print the head of a Markdown table, whose columns of numbers are on the right."""
    print_row(name, columns)
    print_row("---", ruler or ["---:"] * len(columns))
