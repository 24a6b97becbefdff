"""Who is who: decided late, when people who met have parted, and when somebody new is sure to be there.

While people overlap, what is seen of one may be the other. What they look like afterwards is kept apart from
what they looked like before, until it can be compared.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from peopleboy.tracker.by_detection.colours import Colours
from peopleboy.tracker.by_detection.config import IdentityConfig
from peopleboy.tracker.by_detection.target import Target


def resolve(targets: Sequence[Target], time_s: float, config: IdentityConfig) -> None:
    """Let those who met and parted exchange their numbers, if they look like each other did before.

    Who is in sight again for a while is compared with each of those met: with those in sight once they are
    seen as long, with others once they are gone for as long.
    """
    by_id = {target.id: target for target in targets if target.is_told}
    for one in list(by_id.values()):
        if one.clear_s < config.parted_s or not one.recent.any():
            continue
        met = [by_id[number] for number in sorted(one.met) if number in by_id and number != one.id]
        if any(_is_awaited(other, time_s, config) for other in met):
            continue
        gains = [_gain(one, other, config) for other in met]
        if gains and max(gains) > config.margin:
            _exchange(one, met[int(np.argmax(gains))])
        one.settle()


def known_again(
    target: Target, lost: Sequence[Target], is_near: Callable[[Target], bool], config: IdentityConfig
) -> Target | None:
    """Tell which of those who were lost somebody new is, if any.

    Args:
        target: who is new.
        lost: who may be meant.
        is_near: whether somebody may have come here on the way on which he was lost.
        config: how alike they must be.
    """
    likeness = [_alike(target.colours, other.colours) for other in lost]
    best = int(np.argmax(likeness)) if likeness else -1
    if best >= 0 and likeness[best] > config.same:
        return lost[best]
    if target.colours.any():
        return None
    near = [other for other in lost if is_near(other)]
    return near[0] if len(near) == 1 else None


def _is_awaited(other: Target, time_s: float, config: IdentityConfig) -> bool:
    """Tell whether it will soon be known how somebody looks now."""
    return time_s - other.seen_s < config.parted_s and other.clear_s < config.parted_s


def _gain(one: Target, other: Target, config: IdentityConfig) -> float:
    """Tell how much better people fit who they look like if both are the other one."""
    gain = _alike(one.recent, other.colours) - _alike(one.recent, one.colours)
    if other.clear_s >= config.parted_s and other.recent.any():
        gain += _alike(other.recent, one.colours) - _alike(other.recent, other.colours)
    return gain


def _alike(one: Colours, other: Colours) -> float:
    """Give Bhattacharyya's coefficient."""
    return float(one @ other)


def _exchange(one: Target, other: Target) -> None:
    one.id, other.id = other.id, one.id
    one.colours, other.colours = other.colours, one.colours
    one.looks, other.looks = other.looks, one.looks
    other.settle()
