"""Association of tracks with fused people: by bearing and range, appearance, height and history."""

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
from scipy.optimize import linear_sum_assignment

from peopleboy.geometry.small_matrices import mahalanobis2, principal_axes
from peopleboy.tracker.frame import Floats
from peopleboy.tracker.fusion.fused_person import FusedPerson, SensorTrack
from peopleboy.tracker.fusion.fusion_config import FusionConfig
from peopleboy.tracker.rgbd.observation_model import similarity

_NEVER: Final = 1e6


def distance2(person: FusedPerson, reported: SensorTrack, floor_m: float) -> float:
    """Return the squared Mahalanobis distance between a reported position and a person's position.

    A thermal track has a certain bearing and an uncertain range; a depth track is certain of both.
    """
    away = reported.place_m - person.motion.place_m
    error = reported.error_m2 + person.motion.place_m2 + np.eye(2) * floor_m**2
    return mahalanobis2(away, error)


def cost(
    person: FusedPerson, reported: SensorTrack, own: int | None, time_s: float, config: FusionConfig
) -> float:
    """Return the cost of assigning a report to a person; infinite if impossible.

    Args:
        person: the predicted person.
        reported: a tracker's output.
        own: id of that tracker's previous track of the person.
        time_s: [s] current time.
        config: settings.
    """
    if time_s - person.seen_s > config.away_s:
        return np.inf
    away, unlike = distance2(person, reported, config.floor_m), _unlikeness(person, reported, config)
    if reported.id == own:
        loyalty = config.loyalty if reported.box is None else config.loyalty_heat
        return np.inf if away > config.own_gate else away + unlike - loyalty
    is_out = away > config.gate or away + unlike > config.unlike_gate
    return np.inf if is_out else away + unlike


def is_contradicted(person: FusedPerson, reported: SensorTrack, config: FusionConfig) -> bool:
    """Return whether a thermal track has another bearing than a person that depth sees fully."""
    deep = person.deep
    if reported.box is None or deep is None or not deep.is_clear:
        return False
    (xx, xy), (_, yy) = reported.error_m2.tolist()
    _, sight = principal_axes(xx, xy, yy)  # the line of sight, along which the thermal image is uncertain
    x, y = (reported.place_m - deep.place_m).tolist()
    aside_m: float = abs(math.cos(sight) * y - math.sin(sight) * x)
    return aside_m > config.beside_m


def _unlikeness(person: FusedPerson, reported: SensorTrack, config: FusionConfig) -> float:
    """Return the cost of differences in appearance and height; 0 where unknown."""
    found = 0.0
    if reported.appearance is not None and person.appearance is not None:
        found += config.appearance_weight * (1.0 - similarity(person.appearance, reported.appearance))
    if reported.tall_m is not None and reported.is_clear and person.depth is not None:
        found += min(((reported.tall_m - person.tall_m) / config.height_sd_m) ** 2, config.most_height)
    return found


def pairs(
    people: Sequence[FusedPerson],
    reported: Sequence[SensorTrack],
    owns: Sequence[int | None],
    time_s: float,
    config: FusionConfig,
) -> dict[int, int]:
    """Match people and reports, each at most once, at least total cost.

    Args:
        people: N.
        reported: M.
        owns: id of each person's previous track.
        time_s: [s] current time.
        config: settings.

    Returns:
        Index of the report by index of the person.
    """
    costs = [
        [cost(person, one, own, time_s, config) for one in reported]
        for person, own in zip(people, owns, strict=True)
    ]
    return cheapest(np.array(costs).reshape(len(people), len(reported)))


def cheapest(costs: Floats) -> dict[int, int]:
    """Match rows and columns of costs (N, M): as many as possible, at least total cost."""
    if costs.size == 0:
        return {}
    rows, columns = linear_sum_assignment(np.where(np.isfinite(costs), costs, _NEVER))
    chosen = zip(rows.tolist(), columns.tolist(), strict=True)
    return {row: column for row, column in chosen if np.isfinite(costs[row, column])}
