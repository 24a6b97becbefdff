"""Metrics, from the table that prints them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import fields

from docs.generate.markdown import sentence, table
from peopleboy.scenarios.scores.comfort_metrics import ComfortScore
from peopleboy.scenarios.scores.corridor_metrics import CorridorScore
from peopleboy.scenarios.scores.following_metrics import FollowingScore
from peopleboy.tracker.evaluation.table import FIGURES


def metrics(group: str) -> str:
    """List the figures of one group: thesis, paper, mot, floor or counts."""
    rows = [
        (f"**{figure.name}**", figure.unit or ("-" if figure.group == "floor" else "count"), figure.meaning)
        for figure in FIGURES
        if figure.group == group
    ]
    return table(("figure", "unit", "meaning"), rows)


def comfort() -> str:
    """List the figures of people's comfort."""
    score = ComfortScore(
        personal_s=math.nan,
        intimate_s=math.nan,
        personal_intrusions=0,
        intimate_intrusions=0,
        min_time_to_collision_s=math.nan,
        jerk_m_s3=math.nan,
        felt_jerk_m_s3=math.nan,
    )
    rows = [(f"**{name}**", unit or "count", sentence(meaning)) for name, _, unit, meaning in score.rows()]
    return table(("figure", "unit", "meaning"), rows)


def following() -> str:
    """List the figures of following a person."""
    names = [field.name for field in fields(FollowingScore)]
    return _driving(names, FollowingScore(**dict.fromkeys(names, 0)))  # type: ignore[arg-type]


def corridor() -> str:
    """List the figures of following corridors."""
    names = [field.name for field in fields(CorridorScore)]
    return _driving(names, CorridorScore(**dict.fromkeys(names, 0)))


def _driving(keys: Sequence[str], score: FollowingScore | CorridorScore) -> str:
    """List figures with their keys, which are in the same order."""
    rows = [
        (f"**{name}**", f"`{key}`", unit or "count", sentence(meaning))
        for key, (name, _, unit, meaning) in zip(keys, score.rows(), strict=True)
    ]
    return table(("figure", "in `metrics.json`", "unit", "meaning"), rows)
