"""What two trackers believe beyond the tracks that they share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from peopleboy.tracker.contour.explanation import DETECTOR_KEY, ContourExplanation
from peopleboy.tracker.panoramic.people.panoramic_observation import PeopleExplanation
from peopleboy.tracker.rgbd.rgbd_tracker import RgbdExplanation


@dataclass(frozen=True, slots=True, eq=False)
class BothExplanations:
    """What the two trackers believe, by the numbers that they share.

    Attributes:
        thermal: contours and samples in the thermal image.
        panoramic: what is taken for people in the panorama; None before the first.
    """

    thermal: ContourExplanation
    panoramic: PeopleExplanation | None

    @property
    def parts(self) -> tuple[object, ...]:
        """The explanations that it joins."""
        return self.thermal, self.panoramic

    @classmethod
    def of(
        cls, thermal: ContourExplanation, panoramic: PeopleExplanation | None, number: Mapping[int, int]
    ) -> BothExplanations:
        """Join them; `number` gives the shared numbers of the thermal tracks. Who has none is left out."""
        shared = replace(
            thermal,
            ellipses={number[one]: found for one, found in thermal.ellipses.items() if one in number},
            spread_px2={number[one]: found for one, found in thermal.spread_px2.items() if one in number},
            particles={
                number.get(one, DETECTOR_KEY): found
                for one, found in thermal.particles.items()
                if one in number or one == DETECTOR_KEY
            },
        )
        return cls(shared, panoramic)


# What the fused tracker believes beyond its tracks, by the kinds that its parts have.


@dataclass(frozen=True, slots=True, eq=False)
class FusedExplanation:
    """What each part believes.

    Attributes:
        both: of the thermal image and, where there is one, the panorama, by the numbers of the tracks.
        depth: of the depth image; None before the first.
    """

    both: BothExplanations
    depth: RgbdExplanation | None

    @property
    def parts(self) -> tuple[object, ...]:
        """The explanations that it joins."""
        return self.both, self.depth


def parts_of(explanation: object) -> tuple[object, ...]:
    """Return the explanations that one joins or wraps in its `parts`; none of a kind that stands alone."""
    return getattr(explanation, "parts", ())
