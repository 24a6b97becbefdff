"""Explanations of fused trackers: the state behind their tracks."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from peopleboy.tracker.contour.explanation import DETECTOR_KEY, ContourExplanation
from peopleboy.tracker.panoramic.people.panoramic_observation import PeopleExplanation
from peopleboy.tracker.rgbd.rgbd_tracker import RgbdExplanation


@dataclass(frozen=True, slots=True, eq=False)
class BothExplanations:
    """Explanations of the thermal and the panoramic tracker, with shared ids.

    Attributes:
        thermal: contours and samples in the thermal image.
        panoramic: people in the panorama; None before its first image.
    """

    thermal: ContourExplanation
    panoramic: PeopleExplanation | None

    @property
    def parts(self) -> tuple[object, ...]:
        """The joined explanations."""
        return self.thermal, self.panoramic

    @classmethod
    def of(
        cls, thermal: ContourExplanation, panoramic: PeopleExplanation | None, number: Mapping[int, int]
    ) -> "BothExplanations":
        """Join them; `number` maps the thermal tracks to shared ids, and tracks without one are left out."""
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


# Explanation of the fused tracker, by its parts.


@dataclass(frozen=True, slots=True, eq=False)
class FusedExplanation:
    """Explanations of all parts.

    Attributes:
        both: of the thermal image and, if present, the panorama, by track id.
        depth: of the depth image; None before its first image.
    """

    both: BothExplanations
    depth: RgbdExplanation | None

    @property
    def parts(self) -> tuple[object, ...]:
        """The joined explanations."""
        return self.both, self.depth


def parts_of(explanation: object) -> tuple[object, ...]:
    """Return the explanations in the `parts` of a joined one; none for a single explanation."""
    return getattr(explanation, "parts", ())
