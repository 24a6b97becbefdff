"""What a run comes to, in a sentence or two."""

from __future__ import annotations

import math
from typing import Final

from peopleboy.scenarios.scores.corridor_metrics import CorridorScore
from peopleboy.scenarios.scores.following_metrics import FollowingScore
from peopleboy.scenarios.scores.run_scores import RunScores
from peopleboy.sim.truth.truth import (
    COUNTED_FARTHEST_M,
    COUNTED_NEAREST_M,
    ROUND_FARTHEST_M,
    ROUND_NEAREST_M,
)
from peopleboy.tracker.evaluation.evaluate import Scores

_NEAR: Final = (
    f"{COUNTED_NEAREST_M:g} to {COUNTED_FARTHEST_M:g} m away, "
    f"in a panorama {ROUND_NEAREST_M:g} to {ROUND_FARTHEST_M:g} m"
)


def headline(scores: RunScores) -> str:
    """Say how well people were found, and how well the robot did what it was to do."""
    parts = [_people(scores.people)]
    if scores.following is not None:
        parts.append(_following(scores.following))
    if scores.corridor is not None:
        parts.append(_corridor(scores.corridor))
    return " ".join(parts)


def _people(scores: Scores) -> str:
    counts, thesis, mot = scores.counts, scores.thesis, scores.mot
    false = _some(counts.false_tracks, "false track")
    if not counts.targets:
        return f"Nobody was to be found in {counts.frames} frames, which is who is seen {_NEAR}; {false}."
    right = "no box given" if math.isnan(thesis.cp) else f"{_percent(thesis.cp)} of the boxes given are right"
    return (
        f"People were found in {_percent(thesis.cr)} of {counts.targets} cases, {right}; "
        f"{_some(mot.clear.switches, 'identity switch', 'es')}, {false}."
    )


def _following(score: FollowingScore) -> str:
    if not score.found:
        return "The person to follow was never found."
    end = "to the end" if score.followed_to_end else "but not to the end"
    astray = f"the robot went after somebody else for {score.wrong_person_s:.1f} s; "
    return (
        f"The person to follow was found after {score.time_to_find_s:.1f} s and tracked for "
        f"{_percent(100.0 * score.followed)} of the time since, {end}; "
        f"{astray if score.wrong_person_s > 0.0 else ''}{_some(score.collisions, 'contact')}."
    )


def _corridor(score: CorridorScore) -> str:
    way = f"{score.way_m:.1f} m of corridor at {score.mean_speed_m_s:.2f} m/s"
    if not math.isnan(score.lateral_rms_m):
        way += f", {score.lateral_rms_m:.2f} m RMS off the middle"
    return f"The robot drove {way}; {_some(score.contacts, 'contact')}."


def _percent(value: float) -> str:
    """Whole percents, of which 100 means all and 0 none."""
    return f"{min(max(round(value), math.ceil(value > 0)), 99 if value < 100 else 100)} %"


def _some(number: int, noun: str, plural: str = "s") -> str:
    return f"{number or 'no'} {noun}{'' if number in (0, 1) else plural}"
