"""Who is who: decided late, when people who met have parted, and when a person new is sure to be there.

While people overlap, what is seen of one may be the other. What they look like afterwards is compared with
what they looked like before, which is learned no further while they look like another person.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from peopleboy.tracker.tracking.appearance import colour_similarity
from peopleboy.tracker.tracking.config import ReidentificationConfig
from peopleboy.tracker.tracking.track_state import TrackState


def resolve_identity_swaps(
    targets: Sequence[TrackState], time_s: float, config: ReidentificationConfig
) -> None:
    """Let people exchange their numbers who look like each other did before.

    Who is seen apart from others for a while is compared with whoever is so, too, or is gone as long.
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


def reidentify(
    target: TrackState, lost: Sequence[TrackState], config: ReidentificationConfig
) -> TrackState | None:
    """Return by colours which of those who were lost a person new is, if any.

    Args:
        target: who is new.
        lost: who may be meant.
        config: how colour_similarity they must be.
    """
    likeness = [colour_similarity(target.colours, other.colours) for other in lost]
    best = int(np.argmax(likeness)) if likeness else -1
    return lost[best] if best >= 0 and likeness[best] > config.same else None


def _is_clear(target: TrackState, config: ReidentificationConfig) -> bool:
    return target.clear_s >= config.parted_s and bool(target.recent.any())


def _gain(one: TrackState, other: TrackState, config: ReidentificationConfig) -> float:
    """Return how much better people fit who they look like if both are the other one."""
    gain = colour_similarity(one.recent, other.colours) - colour_similarity(one.recent, one.colours)
    if _is_clear(other, config):
        gain += colour_similarity(other.recent, one.colours) - colour_similarity(other.recent, other.colours)
    return gain


def _exchange(one: TrackState, other: TrackState) -> None:
    one.id, other.id = other.id, one.id
    one.colours, other.colours = other.colours, one.colours
    one.pattern, other.pattern = other.pattern, one.pattern
