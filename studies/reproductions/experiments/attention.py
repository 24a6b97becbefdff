"""Tables of chapter 5 of the thesis on situation awareness, and what became of its outlook."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.studies.reproductions.evaluations.attention_focus import (
    CHOICES,
    DEFAULT,
    MATCHING,
    PRINTED_NAME,
)
from peopleboy.studies.reproductions.experiments.experiment import Chart, Done, Line, Samples, missing
from peopleboy.studies.reproductions.measuring.attention_units import (
    AbsenceUnit,
    FocusUnit,
    FollowUnit,
)
from peopleboy.studies.reproductions.measuring.units import Unit
from peopleboy.studies.reproductions.measuring.workload import Plan

Floats = NDArray[np.float64]

FILMS: Final = ("crossing_3", "same_uniform", "crowd_8", "follow_passers_by")
SETS: Final[Mapping[str, tuple[str, ...]]] = {"A": ("follow_passers_by",), "B": ("same_uniform", "crowd_8")}
"""What stands for the thesis's sets: a person who leads the robot past others, and people dressed alike or
many."""

COMPARED: Final = (PRINTED_NAME, MATCHING, DEFAULT)
TRACKERS: Final = ("contour", "attentive-printed", "attentive")
FOLLOWERS: Final = ("attentive", "contour")
ABSENCES: Final = ("absence_10s", "absence_60s")
FOLLOWED: Final = "follow_absence"
_IN_TIME_S: Final = 1.0
_MEASURED: Final = "measured"


@dataclass(frozen=True, slots=True)
class Focus:
    """Table 5.1: how often the focus is on the person that was learned."""

    id: str = "situation-table-5.1"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Every film."""
        return missing(_focus_units(plan), done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give for each set, one video being one person of one film, the figures of all of them."""
        return {
            Line(group, who): _shares(_videos(plan, done, films, who))
            for group, films in SETS.items()
            for who in COMPARED
        }


@dataclass(frozen=True, slots=True)
class FocusWays:
    """What each reading of chapter 5 is worth, by film."""

    id: str = "situation-attention-ways"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Every film."""
        return missing(_focus_units(plan), done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give the share of right focus by film, one figure for each seed."""
        return {
            Line(name, _MEASURED): {
                film: np.array([_right(done[unit.key][name]) for unit in _focus_units(plan, (film,))])
                for film in FILMS
            }
            for name in CHOICES
        }


@dataclass(frozen=True, slots=True)
class Absences:
    """Who is known again after an absence, and who is taken for that person meanwhile."""

    id: str = "situation-absence"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Every film."""
        return missing([unit for film in _absences(plan) for unit in _absence_units(plan, film)], done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give the figures of each film and tracker, by seed."""
        return {
            Line(film, who): _known_again([done[unit.key][who] for unit in _absence_units(plan, film)])
            for film in _absences(plan)
            for who in TRACKERS
        }


@dataclass(frozen=True, slots=True)
class FollowedAgain:
    """Whether a robot goes on with the person who was away."""

    id: str = "situation-follow-absence"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Every run."""
        return missing([unit for who in FOLLOWERS for unit in _follow_units(plan, who)], done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give the figures of each tracker, by seed."""
        runs = {who: [done[unit.key] for unit in _follow_units(plan, who)] for who in FOLLOWERS}
        return {
            Line(FOLLOWED, who): {
                "resumed": np.array([_share(one["resumed"], one["absences"]) for one in rows]),
                "right": np.array([one["right"] / one["images"] for one in rows]),
                "wrong": np.array([one["wrong"] / one["images"] for one in rows]),
            }
            for who, rows in runs.items()
        }


def _focus_units(plan: Plan, films: Sequence[str] = FILMS) -> list[FocusUnit]:
    return [
        FocusUnit(film, seed, tuple(CHOICES), plan.drive_s) for film in films for seed in range(plan.drives)
    ]


def _absences(plan: Plan) -> tuple[str, ...]:
    return ABSENCES[:1] if plan.is_quick else ABSENCES


def _absence_units(plan: Plan, film: str) -> list[AbsenceUnit]:
    return [AbsenceUnit(film, seed, TRACKERS) for seed in range(plan.absences)]


def _follow_units(plan: Plan, who: str) -> list[FollowUnit]:
    return [FollowUnit(FOLLOWED, seed, who) for seed in range(plan.follows)]


def _videos(plan: Plan, done: Done, films: Sequence[str], who: str) -> Floats:
    """Give right, second and wrong of each person of each film (V, 3)."""
    counts = [row for unit in _focus_units(plan, films) for row in done[unit.key][who].values()]
    return np.array(counts, dtype=np.float64).reshape(-1, 3)


def _shares(videos: Floats) -> dict[str, Floats]:
    """Give shares of all images together, and means of videos; also with the second best place."""
    right, second = videos[:, 0], videos[:, :2].sum(axis=1)
    whole = videos.sum(axis=1)
    figures = {
        "pooled": right.sum() / whole.sum(),
        "per video": np.mean(right / whole),
        "pooled, first two": second.sum() / whole.sum(),
        "per video, first two": np.mean(second / whole),
        "images": whole.sum(),
    }
    return {name: np.array([figure]) for name, figure in figures.items()}


def _right(people: Mapping[str, Sequence[int]]) -> float:
    """Give the share of right focus of all people of a film together."""
    counts = np.array(list(people.values()), dtype=np.float64).reshape(-1, 3)
    return _share(counts[:, 0].sum(), counts.sum())


def _known_again(rows: Sequence[Mapping[str, Any]]) -> dict[str, Floats]:
    late, found = (np.array([one[key] for one in rows], np.float64) for key in ("late_s", "found_s"))
    return {
        "right in time": (late <= _IN_TIME_S).astype(np.float64),
        "right at all": np.isfinite(late).astype(np.float64),
        "found in time": (found <= _IN_TIME_S).astype(np.float64),
        "late [s]": late,
        "accepted while away": np.array([_share(one["accepted"], one["away"]) for one in rows]),
    }


def _share(part: float, whole: float) -> float:
    return float(part / whole) if whole else float("nan")


ATTENTION = (Focus(), FocusWays(), Absences(), FollowedAgain())
"""Experiments of chapter 5 of that thesis."""
