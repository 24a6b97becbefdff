"""Settings of visual attention."""

from dataclasses import dataclass
from typing import Final, Literal, get_args

from peopleboy.bad_input import BadInput

Reward = Literal["more", "same"]
Share = Literal["sums", "means"]


@dataclass(frozen=True, slots=True, kw_only=True)
class AttentionConfig:
    """How the 24 maps are computed, what is learned from a box, and what is searched for.

    Attributes:
        inhibits: whether low neighbouring maps raise a map (equation 5.1).
        has_range: whether each map is divided by its maximum before equation 5.3, so that all have one range.
        divides_by_peaks: whether maps with many peaks are weighted down (equation 5.3).
        plain: whether features without centre-surround are used.
        surround: whether features with centre-surround, and their three sums, are used.
        patterns: whether local binary patterns are used.
        head: whether the head is a separate part; otherwise only the torso is used.
        share: of a box in a map: "sums", relative to the whole map (equations 5.4 and 5.5), or "means" inside
            and outside, which do not depend on the size of the box.
        reward: "more" of a feature than the rest has (equations 5.9 to 5.11), or the "same" as in the box.
        is_absolute: whether R is combined with the patterns unscaled; otherwise it is divided by its maximum
            in the frame, so that a person is always found.
        keeps_negative: whether features that speak against the box are subtracted (equation 5.11), or left
            out (the text).
        colour: whether the ratio of colours inside and around the box is used, too.
        maps: whether the maps are used; otherwise only the ratio of colours.
        scales: tested sizes of the parts, relative to the learned size.
        rate: update rate per frame (equations 5.15 and 5.16).
        least: least score of the best position for an update ...
        ahead: ... and its least margin above the second best.

    Raises:
        BadInput: an unknown name, no features at all, or a value out of range.

    Source: situation-awareness thesis, chapter 5.
    """

    inhibits: bool = False
    has_range: bool = False
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
        """Check the values."""
        for key, known in (("share", get_args(Share)), ("reward", get_args(Reward))):
            if getattr(self, key) not in known:
                raise BadInput(
                    f"AttentionConfig: unknown {key} {getattr(self, key)!r}; choose from {', '.join(known)}"
                )
        if not (self.colour or (self.maps and (self.plain or self.surround or self.patterns))):
            raise BadInput("AttentionConfig: maps or colour must be used, got neither")
        if not self.scales or min(self.scales) <= 0.0:
            raise BadInput(f"AttentionConfig: scales must be positive numbers, got {self.scales}")
        if not 0.0 <= self.rate <= 1.0:
            raise BadInput(f"AttentionConfig: rate must be in 0..1, got {self.rate}")


PRINTED: Final = AttentionConfig(
    inhibits=True,
    has_range=True,
    divides_by_peaks=True,
    surround=True,
    reward="more",
    is_absolute=False,
    colour=False,
    scales=(1.0,),
)
"""Chapter 5 as printed.

Equations 5.4 and 5.5 print sums, "normalised according to the complete map with the size k, l". Without the
size of the box, each feature of a box smaller than half of the image speaks against it, and equation 5.11
leaves nothing; in figure 5.6, the learned shirt stands out. The source's maps are images with one range of
grey levels; without one, bright and dark outweigh the other maps many times.
"""
