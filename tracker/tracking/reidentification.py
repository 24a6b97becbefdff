"""Re-identification: identities are resolved late, after people part or a new track is confirmed.

While people overlap, their appearances mix. Appearance after an encounter is compared with appearance before
it, which is not updated while a person resembles another one.
"""

from collections.abc import Sequence
from typing import NamedTuple, Self

import numpy as np
from scipy.optimize import linear_sum_assignment

from peopleboy.geometry.small_matrices import inverse
from peopleboy.tracker.tracking.appearance import (
    FEATURES,
    Colours,
    colour_similarities,
    colour_similarity,
)
from peopleboy.tracker.tracking.config import ReidentificationConfig
from peopleboy.tracker.tracking.motion_filter import Floats, StateEstimates
from peopleboy.tracker.tracking.track_state import TrackState


def resolve_identity_swaps(
    targets: Sequence[TrackState], time_s: float, config: ReidentificationConfig
) -> None:
    """Swap the identities of tracks that resemble each other's earlier appearance.

    Tracks that have been separate for a while are compared with others that are separate, or lost for as
    long.
    """
    known = [target for target in targets if target.is_confirmed and target.colours.any()]
    for one in known:
        if not _is_clear(one, config):
            continue
        others = [
            other
            for other in known
            if other is not one
            and (_is_clear(other, config) or time_s - other.seen_s > config.parted_s)
            and colour_similarity(one.recent, other.colours) > config.same
        ]
        gains = [_gain(one, other, config) for other in others]
        if gains and max(gains) > config.margin:
            _exchange(one, others[int(np.argmax(gains))])


def is_same_again(one: TrackState, lost: TrackState, config: ReidentificationConfig) -> bool | None:
    """Return whether a track still resembles the lost one that it continues; None if that is unclear."""
    if not _is_clear(one, config) or not lost.colours.any():
        return None
    return colour_similarity(one.recent, lost.colours) > config.same_again


class Candidates(NamedTuple):
    """People who may be the same as others: N of them.

    Attributes:
        places_m: (N, 2) to the right and ahead in the level frame.
        velocities_m_s: (N, 2) along the same axes.
        variance_m2: (N, 2, 2) of the places.
        build: (N, 2) logarithm of the stature, and its variance.
        colours: (N, 512).
    """

    places_m: Floats
    velocities_m_s: Floats
    variance_m2: Floats
    build: Floats
    colours: Colours

    @classmethod
    def of(cls, states: StateEstimates, colours: Sequence[Colours] | Colours) -> Self:
        """Take the positions, velocities and statures of states (N) and their colours."""
        mean, covariance = states.mean, states.covariance
        return cls(
            mean[:, (0, 2)],
            mean[:, (3, 5)],
            covariance[:, (0, 0, 2, 2), (0, 2, 0, 2)].reshape(-1, 2, 2),
            np.column_stack([mean[:, 6], covariance[:, 6, 6]]),
            np.reshape(colours, (len(mean), FEATURES)),
        )


def same_person_log_odds(
    lost: Candidates, gone_s: Floats, found: Candidates, config: ReidentificationConfig
) -> Floats:
    """Return the log-odds (L, N) that lost people are the ones who are found, less those needed.

    Args:
        lost: L people, at the places where they were last seen.
        gone_s: (L,) time since then.
        found: N people.
        config: weights of colours, motion and stature.
    """
    same, is_known = colour_similarities(lost.colours, found.colours)
    if not config.uses_place:
        return np.where(is_known, same.astype(np.float64) - config.same, -np.inf)
    by_colour = np.minimum(config.colour_gain * (same - config.colour_neutral), config.colour_most)
    odds = np.where(is_known, by_colour, config.colour_unknown) - config.least
    return np.asarray(
        odds + _by_motion(lost, gone_s, found, config) + _by_stature(lost, found, config), np.float64
    )


def known_person_log_odds(known: Candidates, found: Candidates, config: ReidentificationConfig) -> Floats:
    """Return the log-odds (G, N) that people of a gallery are the ones who are found.

    Colours must be known, as nothing else is sure enough after an absence of any length.
    """
    same, is_known = colour_similarities(known.colours, found.colours)
    by_colour = np.minimum(config.known_gain * (same - config.known_neutral), config.colour_most)
    return np.asarray(np.where(is_known, by_colour + _by_stature(known, found, config), -np.inf), np.float64)


def _by_motion(lost: Candidates, gone_s: Floats, found: Candidates, config: ReidentificationConfig) -> Floats:
    """Return log-odds (L, N) by the way from where people were last seen, or from where they walked to.

    A person who is lost has either stopped or turned, or has walked on; another person may be anywhere.
    """
    still = _nearness(lost.places_m, config.walk_m + config.walk_m_s * gone_s, lost, found, config)
    walked_to_m = lost.places_m + gone_s[:, None] * lost.velocities_m_s
    on = _nearness(walked_to_m, config.walk_m + config.stray_m_s * gone_s, lost, found, config)
    return np.asarray(np.maximum(np.maximum(still, on), config.least_near))


def _nearness(
    places_m: Floats, way_m: Floats, lost: Candidates, found: Candidates, config: ReidentificationConfig
) -> Floats:
    """Return log-odds (L, N) that people found come from places after ways (L,) [m], not from anywhere."""
    away = found.places_m[None] - places_m[:, None]
    walked_m2 = np.square(way_m)[:, None, None, None] * np.eye(2)
    spread = found.variance_m2[None] + lost.variance_m2[:, None] + walked_m2
    squared = (away[:, :, None] @ inverse(spread) @ away[:, :, :, None])[:, :, 0, 0]
    area_m2 = 2.0 * np.pi * np.sqrt(np.linalg.det(spread))
    return np.asarray(np.log(config.room_m2 / np.minimum(area_m2, config.room_m2)) - 0.5 * squared)


def _by_stature(lost: Candidates, found: Candidates, config: ReidentificationConfig) -> Floats:
    """Return the likelihood ratios (L, N), as logarithms, of one person's stature and of two people's."""
    off2 = np.square(lost.build[:, :1] - found.build[:, 0])
    one = lost.build[:, 1:] + found.build[:, 1] + config.stature_error**2
    two = one + 2.0 * config.statures**2
    return np.asarray(0.5 * np.log(two / one) - 0.5 * off2 * (1.0 / one - 1.0 / two))


def assign_lost(odds: Floats) -> dict[int, int]:
    """Return the lost person, by the person found, for all that are clear, from log-odds (L, N)."""
    if odds.size == 0:
        return {}
    rows, columns = linear_sum_assignment(-np.maximum(odds, 0.0))
    return {
        int(column): int(row) for row, column in zip(rows, columns, strict=True) if odds[row, column] > 0.0
    }


def _is_clear(target: TrackState, config: ReidentificationConfig) -> bool:
    return target.clear_s >= config.parted_s and bool(target.recent.any())


def _gain(one: TrackState, other: TrackState, config: ReidentificationConfig) -> float:
    """Return the gain in similarity of appearance if the two tracks swap identities."""
    gain = colour_similarity(one.recent, other.colours) - colour_similarity(one.recent, one.colours)
    if _is_clear(other, config):
        gain += colour_similarity(other.recent, one.colours) - colour_similarity(other.recent, other.colours)
    return gain


def _exchange(one: TrackState, other: TrackState) -> None:
    one.id, other.id = other.id, one.id
    one.colours, other.colours = other.colours, one.colours
    one.pattern, other.pattern = other.pattern, one.pattern
