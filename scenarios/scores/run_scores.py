"""The scores of a run: how well people were found, and how its robot drove."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from peopleboy.scenarios.scores.comfort.comfort_metrics import ComfortScore
from peopleboy.scenarios.scores.corridor_metrics import CorridorScore
from peopleboy.scenarios.scores.following_metrics import (
    FollowingScore,
)
from peopleboy.scenarios.scores.people_scores import ScoredPeople, score_people
from peopleboy.scenarios.scores.yardstick import Yardstick, boxes_held, kind_of_boxes, own_camera
from peopleboy.tracker.evaluation.evaluate import Scores
from peopleboy.tracker.evaluation.table import to_json
from peopleboy.tracker.footage.box_kinds import BoxKind


@dataclass(frozen=True, slots=True, eq=False)
class RunScores:
    """Scores of one run.

    Attributes:
        people: detection, localisation and identity; from the files of the run.
        following: of the first person in the scenario; None if the robot was not to follow anybody.
        corridor: of the way along corridors; None if the robot was not to follow any.
        comfort: of people among whom the robot drove; None if it was not to drive, or nobody was there.
        further: of people by the boxes that the tracker gave in further cameras' images, by camera.
        by: what the boxes of `people` were held against; None for squares on the floor.
        notes: what whoever reads the figures must know, a line each.
    """

    people: Scores
    following: FollowingScore | None
    corridor: CorridorScore | None = None
    comfort: ComfortScore | None = None
    further: Mapping[str, Scores] = field(default_factory=dict)
    by: Yardstick | None = None
    notes: tuple[str, ...] = ()

    def to_json(self) -> dict[str, Any]:
        """Give all figures as JSON can hold them: None for what is undefined."""
        groups: dict[str, Any] = {} if self.by is None else {"scored_by": self.by.to_json()}
        groups |= to_json(self.people)
        drives = {"following": self.following, "corridor": self.corridor, "comfort": self.comfort}
        for group, score in drives.items():
            if score is not None:
                groups[group] = {
                    name: None if isinstance(value, float) and math.isnan(value) else value
                    for name, value in asdict(score).items()
                }
        if self.further:
            groups["cameras"] = {camera: to_json(scores) for camera, scores in self.further.items()}
        return groups


def score_run(
    folder: Path,
    frames: int,
    following: FollowingScore | None,
    corridor: CorridorScore | None = None,
    comfort: ComfortScore | None = None,
    boxes: BoxKind = BoxKind.TORSO,
    tracker: str | None = None,
) -> RunScores:
    """Score a run from the truth and tracks in its folder.

    `boxes` says what the tracker's are drawn round; with its name it is known of ours (`kind_of_boxes`).
    """

    def scored(camera: str) -> ScoredPeople:
        by = Yardstick(camera, kind_of_boxes(folder, camera, tracker, boxes))
        return score_people(folder, boxes_held(folder, by), frames, by)

    people = scored(own_camera(folder))
    further = sorted(path.stem for path in (folder / "tracks").glob("*.txt"))
    return RunScores(
        people.scores,
        following,
        corridor,
        comfort,
        {camera: scored(camera).scores for camera in further},
        people.by,
        people.notes,
    )
