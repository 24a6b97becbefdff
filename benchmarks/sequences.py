"""Recorded sequences: frames, ground truth, and tracks in the form for scoring."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import click

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.loop import closed_loop
from peopleboy.sim.truth.truth import Truth
from peopleboy.sim.world import SimulatedWorld
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
        frames: frames for a tracker.
        truth: boxes of all people.
        boxes_whole: whether boxes enclose whole people.
    """

    frames: tuple[Frame, ...]
    truth: TrueBoxes
    boxes_whole: bool = False

    def uncalibrated(self) -> "Recording":
        """Return the recording without camera calibrations."""
        return replace(self, frames=tuple(replace(frame, calibrations={}) for frame in self.frames))

    def score(self, tracks: Iterable[Sequence[Track]], min_visible: float = 0.0) -> Scores:
        """Score the tracks of each frame; only people with more than a visible share count."""
        if self.boxes_whole:
            tracks = (boxed_whole(each, frame) for each, frame in zip(tracks, self.frames, strict=True))
        found = confirmed_boxes(tracks)
        return evaluate(self.truth, found, frames=len(self.frames), min_visible=min_visible)


def record(scenario: str | Scenario, seed: int) -> Recording:
    """Run a scenario in the closed loop with the contour tracker, and record its frames."""
    loaded = load_scenario(scenario) if isinstance(scenario, str) else scenario
    config = loaded.world(seed)
    frames, rows, before = [], [], None
    with SimulatedWorld(config) as world:
        count = round(loaded.duration_s * config.control_hz)
        tracker = make_tracker(CONTOUR_TRACKER, seed)
        for tick in closed_loop(world, tracker, loaded.make_behaviour(), count):
            frames.append(Frame.from_observation(tick.observation, before))
            before = tick.observation.odometry
            rows += truth_rows(tick.frame, tick.truth)
    return Recording(tuple(frames), TrueBoxes.from_rows(rows))


def truth_rows(frame: int, truth: Truth) -> list[TruthRow]:
    """Return frame, id, box, whether it counts, and visible share of all people with a box."""
    return [
        (frame, person.id, person.box, person.is_counted, person.visible_fraction)
        for person in truth.people
        if person.box is not None
    ]


def confirmed_boxes(frames: Iterable[Iterable[Track]]) -> TrackBoxes:
    """Yield the boxes of confirmed tracks in the thermal image by frame number, from 1 on."""
    return TrackBoxes.from_rows(
        (number, track.id, box, track.confidence)
        for number, tracks in enumerate(frames, start=1)
        for track, box in confirmed(tracks, THERMAL)
    )


def print_row(name: str, cells: Sequence[str]) -> None:
    """Print one row of a Markdown table as soon as it is known."""
    click.echo(f"| {' | '.join((name, *cells))} |")


def print_head(name: str, columns: Sequence[str], ruler: Sequence[str] | None = None) -> None:
    """Print the header of a Markdown table with right-aligned numbers."""
    print_row(name, columns)
    print_row("---", ruler or ["---:"] * len(columns))
