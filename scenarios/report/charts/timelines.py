"""The timelines of a page: what there was to be seen of each person, and what the trackers had."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from peopleboy.scenarios.report.charts.charts import (
    Lane,
    Tick,
    hidden_words,
    mode_lane,
    stray_lane,
    time_ticks,
    track_lane,
    truth_lane,
)
from peopleboy.scenarios.report.columns import Column, are_same_scene
from peopleboy.scenarios.report.findings.sentences import spoken


@dataclass(frozen=True, slots=True)
class PersonLanes:
    """The timelines of one person: the truth, what each run's tracker made of it, and who hid the person."""

    name: str
    lanes: tuple[Lane, ...]
    hidden: str = ""


@dataclass(frozen=True, slots=True)
class Timeline:
    """The timelines of one run or of several runs of one scene."""

    title: str
    people: tuple[PersonLanes, ...]
    ticks: tuple[Tick, ...]


def timelines(columns: Sequence[Column]) -> list[Timeline]:
    """Lay out one timeline a run; but runs of the same scene share one."""
    if len(columns) > 1 and are_same_scene(columns) and _is_same_world(columns):
        return [_timeline(columns, columns[0].run.name)]
    return [_timeline([column], column.label) for column in columns if column.is_single]


def _timeline(columns: Sequence[Column], title: str) -> Timeline:
    first = columns[0].outcomes[0]
    people = []
    for index, story in enumerate(first.stories):
        lanes = [truth_lane(first, story)]
        for column in columns:
            outcome = column.outcomes[0]
            lane = track_lane(outcome, outcome.stories[index])
            lanes.append(lane if len(columns) == 1 else Lane(column.label, lane.bars, lane.marks))
        people.append(PersonLanes(spoken(story.name), tuple(lanes), hidden_words(first, story)))
    for name, make in (("Boxes on nobody", stray_lane), ("The robot", mode_lane)):
        made = [(column.label, make(column.outcomes[0])) for column in columns]
        found = [
            Lane(lane.label if len(columns) == 1 else label, lane.bars)
            for label, lane in made
            if lane is not None
        ]
        if found:
            people.append(PersonLanes(name, tuple(found)))
    return Timeline(title, tuple(people), tuple(time_ticks(first.run.duration_s)))


def _is_same_world(columns: Sequence[Column]) -> bool:
    """Whether everybody was seen alike in all runs: the robot stood or drove the same way."""
    first = columns[0].outcomes[0]
    return all(
        [story.id for story in column.outcomes[0].stories] == [story.id for story in first.stories]
        and all(
            a.sight.shape == b.sight.shape and (a.sight == b.sight).all()
            for a, b in zip(first.stories, column.outcomes[0].stories, strict=True)
        )
        for column in columns[1:]
    )
