"""Result of an episode of an environment, which a saved run repeats: scores, end, and rewards by step."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Final

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from peopleboy.scenarios.scores.comfort_metrics import ComfortScore
from peopleboy.scenarios.scores.corridor_metrics import CorridorScore
from peopleboy.scenarios.scores.drive_record import Metric
from peopleboy.scenarios.scores.following_metrics import FollowingScore
from peopleboy.scenarios.scores.goal_metrics import GoalScore

REWARDS: Final = "rewards.parquet"


@dataclass(frozen=True, slots=True)
class DriveScores:
    """Scores of the robot's tasks; None for a task that it did not have.

    Attributes:
        goal: scores of driving to a goal.
        following: scores of following the first person in the scenario.
        corridor: scores of corridor following.
        comfort: comfort of the people around the robot, if it drove among people.
    """

    goal: GoalScore | None = None
    following: FollowingScore | None = None
    corridor: CorridorScore | None = None
    comfort: ComfortScore | None = None

    @property
    def groups(self) -> dict[str, GoalScore | FollowingScore | CorridorScore | ComfortScore]:
        """The scores of the tasks that the robot had, by their group in metrics.json."""
        groups = {name: getattr(self, name) for name in DRIVE_GROUPS}
        return {name: score for name, score in groups.items() if score is not None}


DRIVE_GROUPS: Final = tuple(field.name for field in fields(DriveScores))
"""Groups of metrics.json on how the robot drove."""

DRIVE_METRICS: Final[Mapping[str, Metric]] = {
    key: metric
    for score in (GoalScore, FollowingScore, CorridorScore, ComfortScore)
    for key, metric in score.metrics().items()
}
"""Metrics of these groups by their key."""


@dataclass(frozen=True, slots=True, eq=False)
class EpisodeResult:
    """What happened in an episode.

    Attributes:
        task: task that the reward is for.
        scores: scores of the drive.
        terms: names of the reward's terms.
        rewards: (N, terms) terms of the reward of each step.
        ended: "collision", "lost", "arrival" or "time"; empty for an episode that goes on.
    """

    task: str
    scores: DriveScores
    terms: Sequence[str]
    rewards: NDArray[np.float64]
    ended: str

    def to_json(self) -> dict[str, Any]:
        """Return the summary for run.json."""
        return {
            "task": self.task,
            "steps": len(self.rewards),
            "ended": self.ended or None,
            "return": float(self.rewards.sum()),
        }

    def write_rewards(self, folder: Path, rate_hz: int) -> None:
        """Write rewards.parquet: the step, from 1, the time at its end, the terms, and their sum."""
        step = np.arange(1, len(self.rewards) + 1)
        columns = {"step": step, "time_s": step / rate_hz}
        columns |= {name: self.rewards[:, k] for k, name in enumerate(self.terms)}
        columns["reward"] = self.rewards.sum(axis=1)
        pq.write_table(pa.table(columns), (folder / REWARDS).absolute())
