"""Limits of contours for the mount of the camera, known or estimated from the people in its image.

A person on the floor has the body's centre at row y = a + b h, where h is the body's semi-height, a the row
of the horizon, and b grows with the camera's height above the floor. Both are estimated from walking people
by recursive least squares.
"""

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.camera_mount import STATURES_M, USUAL_HEIGHT_M, Mount
from peopleboy.tracker.reproductions.contour.contour_config import LimitsConfig, TrackerConfig
from peopleboy.tracker.reproductions.contour.particles import CROWN, FOOT, H, Y
from peopleboy.tracker.reproductions.contour.tracked_person import TrackedPerson
from peopleboy.tracker.track import Status

_HORIZON_SD: Final = 0.2  # [image heights] prior of the row of the horizon
_SLOPE_SD: Final = 0.8  # [body semi-heights] prior of b: cameras between knee and well above the head
_PERSON_SD: Final = 0.4  # [body semi-heights] of a person in one frame; correlated between frames
_SURE: Final = 0.8  # confidence of a person who is used
_WALKS: Final = 0.5  # [body semi-heights/s] of walking people; static ones may be objects
_MIDDLE: Final = 0.5  # [image heights] row of the horizon for a level camera
_REACH: Final = 2.0  # standard deviations by which the limits are widened
_TYPICAL: Final = 0.12  # [image heights] semi-height of people in the middle of a room
_MOST_SAMPLES: Final = 4.0  # greatest factor on the number of samples, where people may be anywhere


@dataclass(frozen=True, slots=True, eq=False)
class MountBelief:
    """Estimated line on which the centres of people of each size lie.

    Attributes:
        line: (2,) row of the horizon [image heights], and distance of a centre below it in semi-heights.
        covariance: (2, 2) of the line.
    """

    line: NDArray[np.float64]
    covariance: NDArray[np.float64]

    @classmethod
    def usual(cls, limits: LimitsConfig) -> "MountBelief":
        """Make the prior, for the standard mount or an unknown one."""
        line = np.array([limits.horizon, sum(limits.y_below_horizon) / 2])
        return cls(line, np.diag([_HORIZON_SD**2, _SLOPE_SD**2]))

    def learnt(self, state: NDArray[np.float64], rows: int) -> "MountBelief":
        """Update with a person's state (9,) in an image of a height in rows."""
        size = float(state[H]) / rows
        row = np.array([1.0, size])
        along = self.covariance @ row
        gain = along / (row @ along + (_PERSON_SD * size) ** 2)
        line = self.line + gain * (float(state[Y]) / rows - row @ self.line)
        return MountBelief(line, self.covariance - np.outer(gain, along))

    def limits(self, given: LimitsConfig) -> LimitsConfig:
        """Transform limits to the estimated line, widened by its uncertainty."""
        horizon, below = self.line.tolist()
        half = (given.y_below_horizon[1] - given.y_below_horizon[0]) / 2
        (first, mixed), (_, last) = (_REACH**2 * self.covariance).tolist()
        return replace(
            self.rows(given),
            horizon=horizon,
            y_below_horizon=(below - half, below + half),
            floor_variance=(first, 2 * mixed, last),
        )

    def width(self, given: LimitsConfig) -> float:
        """Return the factor on the number of samples for the widened limits."""
        half = _TYPICAL * (given.y_below_horizon[1] - given.y_below_horizon[0]) / 2
        row = np.array([1.0, _TYPICAL])
        more = _REACH * math.sqrt(row @ self.covariance @ row)
        return min(1 + more / half, _MOST_SAMPLES)

    def rows(self, given: LimitsConfig) -> LimitsConfig:
        """Widen the limits of rows to all positions on the floor."""
        shift = float(self.line[0]) - _MIDDLE
        more = _REACH * math.sqrt(self.covariance[0, 0])
        lower = max(float(self.line[1]), 0.0) * given.h[1] / 2
        return replace(given, y=(given.y[0] + shift - more, given.y[1] + shift + more + lower))


def is_learnable(config: TrackerConfig) -> bool:
    """Return whether a tracker restricts people to the floor."""
    return all(map(math.isfinite, config.detector.limits.y_below_horizon))


def reports_mount(person: TrackedPerson, rows: int) -> bool:
    """Return whether a person is clearly visible and confirmed: unoccluded, and walking."""
    state = person.belief.estimate
    top, bottom = state[Y] - CROWN * state[H], state[Y] + FOOT * state[H]
    is_whole = person.status is Status.TRACKED and person.missing == 0 and top > 0 and bottom < rows
    is_sure = person.is_settled and person.belief.confidence > _SURE
    return bool(is_whole and is_sure and np.hypot(*person.velocity) > _WALKS * state[H])


def believed_from(config: TrackerConfig, belief: MountBelief) -> TrackerConfig:
    """Transform the limits of both filters to the estimated mount, which may truncate heads."""
    limits = belief.limits(config.detector.limits)
    count = round(belief.width(config.detector.limits) * config.detector.count)
    detector = replace(config.detector, limits=limits, count=count)
    person = replace(config.person, limits=belief.rows(config.person.limits))
    contour = replace(config.contour, unseen_share=config.contour.cut_share)
    return replace(config, contour=contour, detector=detector, person=person)


def seen_from(config: TrackerConfig, mount: Mount, rows: int) -> TrackerConfig:
    """Transform the limits of both filters to another mount."""
    detector, person = (
        replace(samples, limits=limits_seen_from(samples.limits, mount, rows))
        for samples in (config.detector, config.person)
    )
    contour = config.contour
    if mount.cuts_heads:
        contour = replace(contour, unseen_share=contour.cut_share)
    return replace(config, contour=contour, detector=detector, person=person)


def limits_seen_from(limits: LimitsConfig, mount: Mount, rows: int) -> LimitsConfig:
    """Transform limits to another mount, by similar triangles.

    A standing person's feet are as far below the horizon as the camera is high, at any distance. Raising the
    camera by a metre therefore shifts a person of stature S down by (CROWN + FOOT) / S semi-heights.

    Args:
        limits: for a level camera at the usual height.
        mount: of the camera.
        rows: height of its image [px].
    """
    shift = (mount.horizon_px + 0.5) / rows - _MIDDLE
    higher_m = mount.height_m - USUAL_HEIGHT_M
    sunk = [higher_m * (CROWN + FOOT) / stature_m for stature_m in STATURES_M]
    low, high = (y + more for y, more in zip(limits.y_below_horizon, sunk, strict=True))
    reach = high / limits.y_below_horizon[1] if higher_m > 0.0 and math.isfinite(high) else 1.0
    top, bottom = limits.y[0] + shift, limits.y[1] + (limits.y[1] - _MIDDLE) * (reach - 1.0) + shift
    return replace(limits, y=(top, bottom), horizon=_MIDDLE + shift, y_below_horizon=(low, high))
