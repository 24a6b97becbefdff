"""One colour image, ready to be asked what people in it look like."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.thermal.appearance.alignment import Alignment
from peopleboy.tracker.thermal.appearance.colour_moments import normalised_moments
from peopleboy.tracker.thermal.appearance.colour_space import channels_of
from peopleboy.tracker.thermal.appearance.histograms import cumulative_histograms
from peopleboy.tracker.thermal.appearance.power_sums import PowerSums
from peopleboy.tracker.thermal.appearance.regions import Bounds, covered, part_rectangles, pixel_bounds
from peopleboy.tracker.thermal.colour_config import ColourConfig
from peopleboy.tracker.thermal.filter.particles import Floats, H


@dataclass(frozen=True, slots=True, eq=False)
class ColourView:
    """A colour image as all filters see it; build it once a frame.

    The colour image covers only the middle of the thermal one. A part of a person of which less than
    `least_seen` lies in it is unseen: its features are NaN, and comparisons leave them out.

    Attributes:
        picture: (H, W, C) uint8 channels of the configured colour space.
        sums: its integral images; None for histograms.
        alignment: from the thermal image to this one.
        config: how colours are described.
    """

    picture: NDArray[np.uint8]
    sums: PowerSums | None
    alignment: Alignment
    config: ColourConfig

    @classmethod
    def build(
        cls, colour: NDArray[np.uint8], thermal_shape: tuple[int, int], config: ColourConfig
    ) -> ColourView:
        """Prepare an RGB image (H, W, 3) that was taken with a thermal image of `thermal_shape`."""
        picture = channels_of(colour, config)
        sums = PowerSums.build(picture, config.moments) if config.moments else None
        alignment = Alignment.build(thermal_shape, (colour.shape[0], colour.shape[1]), config)
        return cls(picture, sums, alignment, config)

    @property
    def pixels(self) -> int:
        """Pixels of the colour image."""
        return int(self.picture.shape[0]) * int(self.picture.shape[1])

    def describe(self, state: Floats) -> Floats:
        """Describe people by the colours of head, torso and legs.

        Args:
            state: (N, 9) contours in the thermal image.

        Returns:
            (N, F) float32, ordered by part, channel, and moment or bin: F = 27 for three moments in RGB.
        """
        return self.describe_rectangles(part_rectangles(state), state[:, H])

    def describe_rectangles(self, rectangles: Floats, height: Floats, holes: Floats | None = None) -> Floats:
        """Describe regions of people.

        Args:
            rectangles: (N, P, 4) left, top, right, bottom [px], thermal image.
            height: (N,) semi-height h [px] of the people they belong to, for the parallax.
            holes: (N, P, 4) rectangles inside of these that are left out, such as what another person covers.

        Returns:
            (N, F) float32, ordered by rectangle, then channel, then moment or bin.
        """
        bounds = self._bounds(rectangles, height)
        gaps = None if holes is None else _inside(self._bounds(holes, height), bounds)
        if self.sums is None:
            none = np.zeros_like(bounds) if gaps is None else gaps
            config = self.config
            described = cumulative_histograms(self.picture, bounds, none, config.bins, config.least_seen)
        else:
            sums = self.sums.over(bounds)
            whole = sums if gaps is None else sums - self.sums.over(gaps)
            described = normalised_moments(whole, self.config.least_seen)
        return described.reshape(len(rectangles), -1)

    def is_seen(self, state: Floats) -> NDArray[np.bool_]:
        """Tell of which people (N,) at least one part lies in the colour image, and can be described."""
        bounds = self._bounds(part_rectangles(state), state[:, H])
        pixels, area = covered(bounds, *self.picture.shape[:2])
        is_seen = (pixels > 0) & (pixels >= self.config.least_seen * area)
        any_part: NDArray[np.bool_] = is_seen.reshape(len(state), -1).max(axis=1)
        return any_part

    def _bounds(self, rectangles: Floats, height: Floats) -> Bounds:
        """Give the pixels (N P, 4) of this image that thermal rectangles (N, P, 4) cover."""
        return pixel_bounds(self.alignment.apply(rectangles, height)).reshape(-1, 4)


def _inside(part: Bounds, whole: Bounds) -> Bounds:
    """Cut rectangles (M, 4) down to what lies inside of others; empty where nothing does."""
    start = np.maximum(part[:, :2], whole[:, :2])
    end = np.maximum(np.minimum(part[:, 2:], whole[:, 2:]), start)
    return np.concatenate([start, end], axis=1)
