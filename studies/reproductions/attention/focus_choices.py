"""Ways to direct attention that are compared, each with one thing done otherwise than another."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from peopleboy.tracker.attention.attention_config import PRINTED, AttentionConfig

PRINTED_NAME: Final = "printed"
MATCHING: Final = "matching maps"
DEFAULT: Final = "default"

_MEANS: Final = replace(PRINTED, share="means")
_FREE: Final = replace(_MEANS, inhibits=False, divides_by_peaks=False)
_ABSOLUTE: Final = replace(_FREE, is_absolute=True)
_ALIKE: Final = replace(_ABSOLUTE, reward="same")
_SCALED: Final = replace(_ALIKE, scales=AttentionConfig().scales)
_PLAIN: Final = AttentionConfig(colour=False)

CHOICES: Final[Mapping[str, AttentionConfig]] = {
    PRINTED_NAME: PRINTED,
    "means, not sums": _MEANS,
    "nothing against the box": replace(_MEANS, keeps_negative=False),
    "no number of peaks": replace(_MEANS, divides_by_peaks=False),
    "no lateral inhibition": replace(_MEANS, inhibits=False),
    "neither of them": _FREE,
    "absolute score": _ABSOLUTE,
    "the same, not more": _ALIKE,
    "three sizes": _SCALED,
    MATCHING: _PLAIN,
    "no patterns": replace(_PLAIN, patterns=False),
    "torso alone": replace(_PLAIN, head=False),
    "colour ratio alone": AttentionConfig(maps=False),
    DEFAULT: AttentionConfig(),
}
"""By name. Those down to "neither of them" change one thing, or both, of "means, not sums"; from there on
each has what the ones above it have. "matching maps" leaves out centre-surround, the two below it one thing
more; the default adds the ratio of colours to it."""
