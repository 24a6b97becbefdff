"""Plays controllers in the same worlds, and prints how they did."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import gymnasium
import numpy as np
from rich.console import Console
from rich.table import Table

from peopleboy.scenarios.scores.bootstrap import bootstrap

FIGURES = {
    "reward": ("reward of an episode", 1.0, ""),
    "found": ("found the person", 100.0, "%"),
    "followed": ("person tracked since", 100.0, "%"),
    "in_band": ("within 1.2 m of the right distance", 100.0, "%"),
    "facing": ("within 10 deg of the nose", 100.0, "%"),
    "mean_distance_error_m": ("distance error", 1.0, "m"),
    "collided": ("episodes with a collision", 100.0, "%"),
    "lost": ("episodes in which the person was lost", 100.0, "%"),
}
"""What is printed of an episode: its name, factor and unit; see `FollowingScore`."""

Controller = Callable[[Any], Any]
Figures = Mapping[str, float]


def play(env: gymnasium.Env[Any, Any], controller: Controller, seed: int) -> Figures:
    """Play one episode and give its figures."""
    observation, info = env.reset(seed=seed)
    reward, is_over = 0.0, False
    while not is_over:
        observation, earned, terminated, truncated, info = env.step(controller(observation))
        reward, is_over = reward + float(earned), terminated or truncated
    ends = {"collided": float(info["reward"]["collision"] < 0), "lost": float(info["reward"]["lost"] < 0)}
    return {**info["metrics"]["following"], **ends, "reward": reward}


def print_figures(title: str, runs: Mapping[str, Sequence[Figures]], console: Console) -> None:
    """Print a row for each figure: means over the seeds, with bootstrap intervals of 95 %."""
    console.print(title, soft_wrap=True)  # as a table's title, it would be wrapped to the table's width
    table = Table(box=None)
    table.add_column("")
    for name in runs:
        table.add_column(name, justify="right")
    for figure, (words, factor, unit) in FIGURES.items():
        cells = []
        for played in runs.values():
            found = bootstrap([factor * figures[figure] for figures in played], np.random.default_rng(0))
            cells.append(f"{found.mean:.2f} [{found.low:.2f}, {found.high:.2f}]")
        table.add_row(f"{words}{', ' + unit if unit else ''}", *cells)
    console.print(table)
