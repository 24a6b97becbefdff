"""Collect the scores of a run, tracking and driving, and summarise them in a sentence or two."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

from peopleboy.scenarios.scores.contacts import Contact
from peopleboy.scenarios.scores.corridor_metrics import CorridorScore
from peopleboy.scenarios.scores.episode_result import DriveScores
from peopleboy.scenarios.scores.evaluate_runs import (
    BoxReference,
    ScoredPeople,
    kind_of_boxes,
    own_camera,
    read_reference_boxes,
    score_people,
)
from peopleboy.scenarios.scores.following_metrics import FollowingScore
from peopleboy.scenarios.scores.goal_metrics import GoalScore
from peopleboy.sim.truth.truth import (
    COUNTED_FARTHEST_M,
    COUNTED_NEAREST_M,
    ROUND_FARTHEST_M,
    ROUND_NEAREST_M,
)
from peopleboy.tracker.evaluation.evaluate import Scores
from peopleboy.tracker.evaluation.table import to_json
from peopleboy.tracker.footage.box_kinds import BoxKind


@dataclass(frozen=True, slots=True, eq=False)
class RunScores:
    """Scores of one run.

    Attributes:
        people: detection, localisation and identity; from the files of the run.
        drive: scores of the robot's tasks.
        further: scores of people in the images of further cameras for which the tracker returns boxes.
        by: ground-truth boxes that the scores of `people` refer to; None for squares on the floor.
        notes: caveats of the scores, one line each.
        contacts: bodies that the robot touched, with speeds and causes.
    """

    people: Scores
    drive: DriveScores = field(default_factory=DriveScores)
    further: Mapping[str, Scores] = field(default_factory=dict)
    by: BoxReference | None = None
    notes: tuple[str, ...] = ()
    contacts: tuple[Contact, ...] = ()

    def __repr__(self) -> str:
        """Summarise the run."""
        return f"RunScores({headline(self)!r})"

    def to_json(self) -> dict[str, Any]:
        """Return all metrics for JSON, with None for undefined values."""
        groups: dict[str, Any] = {} if self.by is None else {"scored_by": self.by.to_json()}
        groups |= to_json(self.people)
        groups |= {group: score.to_json() for group, score in self.drive.groups.items()}
        if self.contacts:
            groups["contacts"] = [contact.to_json() for contact in self.contacts]
        if self.further:
            groups["cameras"] = {camera: to_json(scores) for camera, scores in self.further.items()}
        return groups


def score_run(
    folder: Path,
    frames: int,
    drive: DriveScores | None,
    boxes: BoxKind = BoxKind.TORSO,
    tracker: str | None = None,
) -> RunScores:
    """Score a run from the ground truth and tracks in its folder.

    `drive` has the scores of the robot's tasks; `boxes` is what the tracker's boxes enclose, see
    `kind_of_boxes` for PeopleBoy's own trackers.
    """

    def scored(camera: str) -> ScoredPeople:
        by = BoxReference(camera, kind_of_boxes(folder, camera, tracker, boxes))
        return score_people(folder, read_reference_boxes(folder, by), frames, by)

    people, drive = scored(own_camera(folder)), drive or DriveScores()
    further = sorted(path.stem for path in (folder / "tracks").glob("*.txt"))
    return RunScores(
        people.scores,
        drive,
        {camera: scored(camera).scores for camera in further},
        people.by,
        people.notes,
    )


_NEAR: Final = (
    f"{COUNTED_NEAREST_M:g} to {COUNTED_FARTHEST_M:g} m away, "
    f"in a panorama {ROUND_NEAREST_M:g} to {ROUND_FARTHEST_M:g} m"
)


def headline(scores: RunScores) -> str:
    """Summarise the task of the robot, then the detection of people."""
    parts = []
    drive = scores.drive
    if drive.goal is not None:
        parts.append(_goal(drive.goal))
    if drive.following is not None:
        parts.append(_following(drive.following))
    if drive.corridor is not None:
        parts.append(_corridor(drive.corridor))
    parts.append(_people(scores.people))
    return " ".join(parts)


def _people(scores: Scores) -> str:
    counts, thesis, mot = scores.counts, scores.thesis, scores.mot
    false = _some(counts.false_tracks, "false track")
    if not counts.targets:
        return f"No person was due to be found in {counts.frames} frames (visible people {_NEAR}); {false}."
    right = "there are no boxes" if math.isnan(thesis.cp) else f"{_percent(thesis.cp)} of boxes are correct"
    return (
        f"People were found in {_percent(thesis.cr)} of {counts.targets} cases, {right}; "
        f"{_some(mot.clear.switches, 'identity switch', 'es')}, {false}."
    )


def _goal(score: GoalScore) -> str:
    contacts = _some(score.contacts, "contact")
    if not score.reached:
        return f"The robot did not reach the goal: it came within {score.nearest_m:.1f} m; {contacts}."
    return (
        f"The robot reached the goal after {score.time_s:.1f} s and {score.path_m:.1f} m, "
        f"SPL {score.spl:.2f}; {contacts}."
    )


def _following(score: FollowingScore) -> str:
    if not score.found:
        return "The person to follow was never found."
    end = "to the end" if score.followed_to_end else "but not to the end"
    astray = f"the robot followed another person for {score.wrong_person_s:.1f} s; "
    return (
        f"The person to follow was found after {score.time_to_find_s:.1f} s and tracked for "
        f"{_percent(100.0 * score.followed)} of the time since, {end}; "
        f"{astray if score.wrong_person_s > 0.0 else ''}{_some(score.collisions, 'contact')}."
    )


def _corridor(score: CorridorScore) -> str:
    way = f"{score.way_m:.1f} m of corridor at {score.mean_speed_m_s:.2f} m/s"
    if not math.isnan(score.lateral_rms_m):
        way += f", with a lateral error of {score.lateral_rms_m:.2f} m RMS"
    return f"The robot drove {way}; {_some(score.contacts, 'contact')}."


def _percent(value: float) -> str:
    """Format whole percents, so that 100 means all and 0 none."""
    return f"{min(max(round(value), math.ceil(value > 0)), 99 if value < 100 else 100)} %"


def _some(number: int, noun: str, plural: str = "s") -> str:
    return f"{number or 'no'} {noun}{'' if number in (0, 1) else plural}"
