"""Generate the tables of metrics from their declarations."""

from __future__ import annotations

from docs.generate.markdown import sentence, table
from peopleboy.scenarios.scores.comfort_metrics import ComfortScore
from peopleboy.scenarios.scores.corridor_metrics import CorridorScore
from peopleboy.scenarios.scores.drive_record import ScoreRecord
from peopleboy.scenarios.scores.following_metrics import FollowingScore
from peopleboy.scenarios.scores.goal_metrics import GoalScore
from peopleboy.tracker.evaluation.table import FIGURES


def metrics(group: str) -> str:
    """List the metrics of one group: thesis, paper, mot, sets, floor, latency or counts."""
    rows = [
        (
            f"**{figure.name}**",
            f"`{figure.key}`",
            figure.unit or ("-" if figure.group in ("floor", "sets") else "count"),
            figure.meaning,
        )
        for figure in FIGURES
        if figure.group == group
    ]
    return table(("metric", "key in JSON", "unit", "meaning"), rows)


def comfort() -> str:
    """List the metrics of people's comfort."""
    figures = ComfortScore.metrics().values()
    rows = [(f"**{one.name}**", one.unit or "count", sentence(one.meaning)) for one in figures]
    return table(("metric", "unit", "meaning"), rows)


def goal() -> str:
    """List the metrics of driving to a goal."""
    return _driving(GoalScore)


def following() -> str:
    """List the metrics of person following."""
    return _driving(FollowingScore)


def corridor() -> str:
    """List the metrics of corridor following."""
    return _driving(CorridorScore)


def _driving(score: type[ScoreRecord]) -> str:
    """List metrics with their keys."""
    rows = [
        (f"**{one.name}**", f"`{key}`", one.unit or "count", sentence(one.meaning))
        for key, one in score.metrics().items()
    ]
    return table(("metric", "in `metrics.json`", "unit", "meaning"), rows)
