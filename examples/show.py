"""Run controllers in the same worlds, and print their metrics."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import gymnasium
import numpy as np
from rich.console import Console
from rich.table import Table

from peopleboy.scenarios.scores.bootstrap import Interval, bootstrap

FIGURES = {
    "reward": ("reward of an episode", 1.0, ""),
    "found": ("found the person", 100.0, "%"),
    "followed": ("person tracked afterwards", 100.0, "%"),
    "in_band": ("within 1.2 m of the right distance", 100.0, "%"),
    "facing": ("within 10 deg of the nose", 100.0, "%"),
    "mean_distance_error_m": ("distance error", 1.0, "m"),
    "collided": ("episodes with a collision", 100.0, "%"),
    "lost": ("episodes in which the person was lost", 100.0, "%"),
    "personal_s": ("a person within 1.2 m", 1.0, "s"),
    "jerk_m_s3": ("jerk", 1.0, "m/s3"),
}
"""Printed metrics of an episode: label, factor and unit; see `FollowingScore` and `ComfortScore`."""

Controller = Callable[[Any], Any]
Figures = Mapping[str, float]


def play(env: gymnasium.Env[Any, Any], controller: Controller, seed: int) -> Figures:
    """Run one episode, and return its metrics."""
    observation, info = env.reset(seed=seed)
    reward, is_over = 0.0, False
    while not is_over:
        observation, earned, terminated, truncated, info = env.step(controller(observation))
        reward, is_over = reward + float(earned), terminated or truncated
    ends = {"collided": float(info["reward"]["collision"] < 0), "lost": float(info["reward"]["lost"] < 0)}
    return {**info["metrics"]["following"], **info["metrics"]["comfort"], **ends, "reward": reward}


def print_figures(title: str, runs: Mapping[str, Sequence[Figures]], console: Console) -> None:
    """Print one row per metric: means over the worlds, with 95 % bootstrap intervals.

    With two controllers, a further column shows their paired differences.
    """
    console.print(title, soft_wrap=True)  # a table's title would be wrapped to the table's width
    table = Table(box=None)
    table.add_column("")
    for name in summary(runs):
        table.add_column(name, justify="right")
    for figure, (words, _, unit) in FIGURES.items():
        cells = [
            f"{found.mean:.2f} [{found.low:.2f}, {found.high:.2f}]" if found.is_known else f"{found.mean:.2f}"
            for found in (of_one[figure] for of_one in summary(runs).values())
        ]
        table.add_row(f"{words}{', ' + unit if unit else ''}", *cells)
    console.print(table)


def summary(runs: Mapping[str, Sequence[Figures]]) -> dict[str, dict[str, Interval]]:
    """Return the metrics of each controller, and of two also the differences, paired by world."""
    values = {
        name: {
            figure: np.array([factor * one[figure] for one in played])
            for figure, (_, factor, _) in FIGURES.items()
        }
        for name, played in runs.items()
    }
    if len(values) == 2:
        (one, first), (other, second) = values.items()
        values[f"{one} - {other}"] = {figure: first[figure] - second[figure] for figure in FIGURES}
    return {
        name: {figure: bootstrap(list(array), np.random.default_rng(0)) for figure, array in arrays.items()}
        for name, arrays in values.items()
    }
