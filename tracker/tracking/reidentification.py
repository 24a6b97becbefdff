"""Re-identification: identities are resolved late, after people part or a new track is confirmed.

While people overlap, their appearances mix. Appearance after an encounter is compared with appearance before
it, which is not updated while a person resembles another one.
"""

from collections.abc import Sequence

import numpy as np

from peopleboy.tracker.tracking.appearance import colour_similarity
from peopleboy.tracker.tracking.config import ReidentificationConfig
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


def reidentify(
    target: TrackState, lost: Sequence[TrackState], config: ReidentificationConfig
) -> TrackState | None:
    """Return the lost track that a new track continues, by colours, or None.

    Args:
        target: the new track.
        lost: candidate tracks.
        config: required similarity.
    """
    likeness = [colour_similarity(target.colours, other.colours) for other in lost]
    best = int(np.argmax(likeness)) if likeness else -1
    return lost[best] if best >= 0 and likeness[best] > config.same else None


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
