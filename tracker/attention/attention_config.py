"""Every choice in directing attention to a person."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, get_args

from peopleboy.bad_input import BadInput

Reward = Literal["more", "same"]
Share = Literal["sums", "means"]


@dataclass(frozen=True, slots=True, kw_only=True)
class AttentionConfig:
    """How the 24 maps are made, what is learned of a box in them, and what is looked for.

    Attributes:
        inhibits: whether a map is raised where its neighbours are low (equation 5.1).
        divides_by_peaks: whether maps with many peaks count less (equation 5.3).
        plain: whether the features without centre-surround are looked at.
        surround: whether those with it, and the three sums of them, are.
        patterns: whether local binary patterns are.
        head: whether the head is a part of its own; otherwise the torso is all.
        share: of a box in a map: "sums", of the map's whole (equations 5.4 and 5.5), or "means" inside and
            outside, of which a box of any size can have the larger part.
        reward: "more" of a feature than the rest has (equations 5.9 to 5.11), or the "same" as in the box.
        is_absolute: whether R stays as it is before it is mixed with the patterns; otherwise it is given as a
            share of its maximum in the frame, by which a person is always found.
        keeps_negative: whether features that speak against the box are subtracted, as equation 5.11 says, or
            left out, as the text does.
        colour: whether the ratio of colours in the box and around it is looked at, too.
        maps: whether the maps are looked at at all, or the ratio of colours alone.
        scales: sizes of the parts that are tried, of the learned one's.
        rate: share of what is seen that is learned anew in each frame (equations 5.15 and 5.16).
        least: score of the best place from which on something is learned anew ...
        ahead: ... and by how much it must be above that of the second best one.

    Raises:
        BadInput: a name that does not exist, nothing to look at, or a number out of its range.

    Source: situation-awareness thesis, chapter 5.
    """

    inhibits: bool = False
    divides_by_peaks: bool = False
    plain: bool = True
    surround: bool = False
    patterns: bool = True
    head: bool = True
    share: Share = "means"
    reward: Reward = "same"
    is_absolute: bool = True
    keeps_negative: bool = True
    colour: bool = True
    maps: bool = True
    scales: tuple[float, ...] = (0.8, 1.0, 1.25)
    rate: float = 0.02
    least: float = 0.5
    ahead: float = 0.05

    def __post_init__(self) -> None:
        """Refuse what cannot be done."""
        for key, known in (("share", get_args(Share)), ("reward", get_args(Reward))):
            if getattr(self, key) not in known:
                raise BadInput(
                    f"AttentionConfig: {key} must be one of {', '.join(known)}, got {getattr(self, key)!r}"
                )
        if not (self.colour or (self.maps and (self.plain or self.surround or self.patterns))):
            raise BadInput("AttentionConfig: there must be maps, or colour, to look at")
        if not self.scales or min(self.scales) <= 0.0:
            raise BadInput(f"AttentionConfig: scales must be positive numbers, got {self.scales}")
        if not 0.0 <= self.rate <= 1.0:
            raise BadInput(f"AttentionConfig: rate must be in 0..1, got {self.rate}")


PRINTED: Final = AttentionConfig(
    inhibits=True,
    divides_by_peaks=True,
    surround=True,
    share="sums",
    reward="more",
    is_absolute=False,
    colour=False,
    scales=(1.0,),
)
"""Chapter 5 as it is printed."""
