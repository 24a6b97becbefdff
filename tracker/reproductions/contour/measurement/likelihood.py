"""Likelihood of contours: their fit to the image, and their visible share.

All variants share the one kernel that reads the image.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.reproductions.contour.contour_config import (
    REFERENCE_HEIGHT_PX,
    ContourConfig,
    LikelihoodConfig,
)
from peopleboy.tracker.reproductions.contour.measurement.contour import (
    FEET,
    GREYS,
    HEAD_ASPECT,
    HEAD_RIGHT,
    Probes,
    build_probes,
    build_response,
    section_weights,
)
from peopleboy.tracker.reproductions.contour.measurement.measure_sections import (
    fill_unknown,
    locate_points,
    logistic,
    measure_sections,
    share_in_view,
    weighted_sums,
)
from peopleboy.tracker.reproductions.contour.particles import FOOT, HEAD_DIVISOR, D, Floats, H, W, X, Y

FEET_GAIN = 3.0  # factor on the response of the feet, up to 1: they fill only a third of their line
COVERED = 0
"""Grey that marks pixels of people in front; no other pixel has it."""
NO_GREY = -2
BLACK_GREY = 4  # greatest black, with noise
LEGS_WIDTH = 0.75  # half width of the legs, in body semi-widths
_SUBPIXEL_BITS = 4
_SCALE = 1 << _SUBPIXEL_BITS


CLUTTER_SETTLES_S: Final = 0.5  # time constant with which a tracker follows changes of the clutter
_APART_PX: Final = 8  # of 240 rows: between the two pixels of a pair
_SHARE: Final = 0.75  # quantile of the pairs' differences, which excludes people, lamps and windows
_STRIDE: Final = 4
_EXTREME: Final = 40.0  # log-odds beyond which the probability no longer changes, and exp would overflow


def _superellipse(power: float, count: int = 32) -> NDArray[np.float64]:
    """Return the outline (count, 2) of a shape between an ellipse (power 2) and a square."""
    angle = np.linspace(0.0, 2 * np.pi, count, endpoint=False)
    around = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    outline: NDArray[np.float64] = np.sign(around) * np.abs(around) ** (2 / power)
    return outline


BODY = _superellipse(3.5)  # shoulders and arms fill the corners of the ellipse


@dataclass(frozen=True, slots=True, eq=False)
class ContourModel:
    """A contour model for one image size; build it once, use it for every frame.

    Attributes:
        shape: (H, W) of the images.
        config: its settings.
        probes: the points to sample.
        response: (8, 511) response to a grey difference.
        weights: (8,) of the sections.
    """

    shape: tuple[int, int]
    config: ContourConfig
    probes: Probes
    response: Floats
    weights: NDArray[np.float64]

    @classmethod
    def build(cls, shape: tuple[int, int], config: ContourConfig) -> "ContourModel":
        """Make the model for images of (H, W) pixels."""
        size = shape[0] / REFERENCE_HEIGHT_PX
        return cls(shape, config, build_probes(config, size), build_response(config), section_weights(config))

    def prepare(self, thermal: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Convert a thermal image (H, W) to the one in which contours are measured."""
        return person_grey(thermal, self.config)

    def amid(self, clutter_grey: float) -> "ContourModel":
        """Return a model whose response saturates at this clutter, if that is larger."""
        bend = round(self.config.clutter_share * clutter_grey)
        if bend <= self.config.saturation_grey:
            return self
        return replace(self, response=_bent(self.config, bend))

    def differences(
        self,
        image: NDArray[np.uint8],
        state: Floats,
        covered: float | None = None,
        covered_share: float = 1.0,
    ) -> Floats:
        """Measure every section of every sample in a preprocessed image, (N, 8).

        Where points above the image, or on people in front, have reduced weight, the section's remaining
        weight gets the average of the other sections.

        Args:
            image: (H, W) preprocessed.
            state: (N, 9) samples.
            covered: response of a point where a person in front is marked in the image; None without marks.
            covered_share: weight of such a point.
        """
        config = self.config
        result, known = _measured(
            image,
            state,
            self.probes,
            self.response,
            (config.unseen_response, config.unseen_share),
            (covered, covered_share),
            FEET_GAIN if config.feet_weight > 0 else 0.0,
        )
        if min(config.unseen_share, covered_share) < 1:
            fill_unknown(result, known, self.weights.astype(np.float32))
        return result


@lru_cache(maxsize=64)
def _bent(config: ContourConfig, bend_grey: int) -> Floats:
    return build_response(replace(config, saturation_grey=float(bend_grey)))


def clutter_of(image: NDArray[np.uint8]) -> float:
    """Return the clutter: the typical difference [grey] between nearby pixels of an image (H, W).

    Noise, texture and a high gain increase it; people, lamps and windows cover too little of an image.
    """
    apart = max(round(_APART_PX * image.shape[0] / REFERENCE_HEIGHT_PX), 1)
    rows, columns = image[::_STRIDE], image[:, ::_STRIDE]
    pairs = (rows[:, apart:], rows[:, :-apart]), (columns[apart:], columns[:-apart])
    apart_by = np.concatenate([(np.maximum(*pair) - np.minimum(*pair)).ravel() for pair in pairs])
    counts = cv2.calcHist([apart_by], [0], None, [GREYS], [0, GREYS]).cumsum(dtype=np.float64)
    return float(np.searchsorted(counts, _SHARE * apart_by.size))


def settled_clutter(before: float | None, now: float, dt_s: float) -> float:
    """Low-pass the clutter [grey], so that the evidence for people does not fluctuate."""
    if before is None:
        return now
    return before + (1 - math.exp(-dt_s / CLUTTER_SETTLES_S)) * (now - before)


def fitness(differences: Floats, weights: NDArray[np.float64], config: LikelihoodConfig) -> Floats:
    """Return the fitness (N,) of each sample from its section differences (N, 8).

    Source: thesis, equation 4.3; paper, equations 3 and 4, where the plain sum of the differences is
    multiplied by the weight of those sections that reach a threshold. The paper's sum is divided by the
    number of sections here, so that both fitnesses are grey levels and share one threshold.
    """
    if config.model == "thesis":
        total: Floats = weighted_sums(differences, weights, config.weakest_share)
        return total
    strong = weighted_sums((differences >= config.section_threshold).astype(np.float32), weights, 0.0)
    used = int((weights > 0).sum())
    product: Floats = strong * (differences.sum(axis=1) / np.float32(used))
    return product


def probability(fit: Floats, config: LikelihoodConfig) -> Floats:
    """Map a fitness (N,) to 0..1; 0.5 at the threshold.

    Source: thesis, equation 4.4, which equals the logistic function of 2 kappa (f - theta).
    """
    chance: Floats = logistic(fit, config.slope, config.threshold, _EXTREME)
    return chance


def person_grey(thermal: NDArray[np.uint8], config: ContourConfig) -> NDArray[np.uint8]:
    """Set pixels too hot for a person to the coldest grey, (H, W) in and out.

    Lamps and radiators thus lose their bright outline, and people in front of them regain theirs. Only a
    scale that starts above room temperature, so that the room is black, is known to end above people.
    """
    if config.hottest_grey >= GREYS or _is_bright(thermal, config.dark_share):
        return np.ascontiguousarray(thermal)
    if thermal.max() < config.hottest_grey:
        return np.ascontiguousarray(thermal)
    side = 2 * config.hot_margin_px + 1
    # Mask arithmetic in OpenCV is faster than np.where.
    is_cooler = np.asarray(cv2.inRange(thermal, 0, config.hottest_grey - 1), np.uint8)
    kept = np.asarray(cv2.erode(is_cooler, np.ones((side, side), np.uint8)), np.uint8)
    return np.bitwise_and(kept, thermal)


def _is_bright(thermal: NDArray[np.uint8], dark_share: float) -> bool:
    """Return whether less than a share of an image (H, W) is black."""
    some = thermal[::2, ::2]
    return dark_share > 0 and bool(np.count_nonzero(some <= BLACK_GREY) < dark_share * some.size)


def section_differences(
    image: NDArray[np.uint8],
    state: Floats,
    probes: Probes,
    response: Floats,
    unseen: float,
    covered: float | None = None,
) -> Floats:
    """Measure the mean response (N, 8) of every section of every sample, D_j of equation 4.3.

    Args:
        image: (H, W) grey.
        state: (N, 9) samples.
        probes: the points to look at.
        response: (8, 511) response to a grey difference.
        unseen: response of a pair with a point outside the image.
        covered: response of a pair with a point on a person in front; None in an image without such marks.
    """
    return _measured(image, state, probes, response, (unseen, 1.0), (covered, 1.0))[0]


def _measured(
    image: NDArray[np.uint8],
    state: Floats,
    probes: Probes,
    response: Floats,
    unseen: tuple[float, float],
    covered: tuple[float | None, float],
    feet_gain: float = 0.0,
) -> tuple[Floats, Floats]:
    """Measure sections as `section_differences` does, and the share of weight that they keep.

    The latter is (N, 8), or (0, 8) if all sections keep all of it.

    Args:
        image: (H, W) grey.
        state: (N, 9) samples.
        probes: the points to look at.
        response: (8, 511) response to a grey difference.
        unseen: response of a pair with a point outside the image, and its weight above it.
        covered: the same with a point on a person in front; None in an image without such marks.
        feet_gain: factor on the response of the feet, limited to 1; 0 leaves it unchanged.
    """
    grey = NO_GREY if covered[0] is None else COVERED
    missing = float(unseen[0]), float(unseen[1]), float(covered[0] or 0.0), float(covered[1])
    measured: tuple[Floats, Floats] = measure_sections(
        image, state, probes.mix, probes.same, probes.first, response, grey, missing, feet_gain
    )
    return measured


def pixels_under(state: Floats, probes: Probes, shape: tuple[int, int]) -> NDArray[np.int32]:
    """Return the pixels nearest to a contour's points (2 P,), all inner ones before all outer ones.

    Args:
        state: (9,) of a person.
        probes: the points.
        shape: (H, W) of the image.

    Returns:
        Index of each pixel, row by row; negative outside the image.
    """
    at = np.empty(probes.mix.shape[1], dtype=np.int32)
    locate_points(at, state, probes.mix, shape[1], shape[0])
    return at


def covered_by(
    image: NDArray[np.uint8],
    states: Sequence[NDArray[np.float64]],
    growth: float = 1.0,
) -> NDArray[np.uint8]:
    """Copy an image (H, W), and mark in it the pixels covered by people with these states (9,)."""
    marked = uncovered(image)
    for state in states:
        cover(marked, state, growth)
    return marked


def uncovered(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Copy a grey image (H, W) without pixels of the marking grey."""
    return np.maximum(image, np.uint8(COVERED + 1))


def cover(image: NDArray[np.uint8], state: NDArray[np.float64], growth: float = 1.0) -> None:
    """Mark the pixels (H, W) of a person with this state (9,) as covered, in place.

    Args:
        image: grey, (H, W).
        state: of the person in front.
        growth: factor by which body, head and legs are widened.
    """
    x, y, d, w, h = (float(state[k]) for k in (X, Y, D, W, H))
    if not (w > 0 and h > 0 and np.isfinite(state[:5]).all()):
        return
    head = h / HEAD_DIVISOR
    outline = BODY * (growth * w, h) + (x, y)
    cv2.fillPoly(image, [np.rint(outline * _SCALE).astype(np.int32)], COVERED, cv2.LINE_8, _SUBPIXEL_BITS)
    _fill_ellipse(image, x + d, y - h - head, growth * HEAD_ASPECT * head, growth * head)
    legs = growth * LEGS_WIDTH * w
    left, right = round(x - legs), round(x + legs)
    image[max(round(y), 0) : max(round(y + FOOT * h), 0), max(left, 0) : max(right + 1, 0)] = COVERED


def seen_shares(image: NDArray[np.uint8], state: NDArray[np.float64], probes: Probes) -> NDArray[np.float64]:
    """Return the share (8,) of every section's pairs of points inside the image and not covered.

    A section without points counts as visible.

    Args:
        image: (H, W) with covered pixels marked.
        state: (9,) of a person.
        probes: the points of its contour.
    """
    sample = state.astype(np.float32)
    shares: NDArray[np.float64] = share_in_view(image, sample, probes.mix, probes.first, COVERED)
    return shares


def head_share(shares: NDArray[np.float64]) -> float:
    """Return the mean visible share of the head's sections (8,)."""
    return float(np.add.reduce(shares[: HEAD_RIGHT + 1])) / (HEAD_RIGHT + 1)


def body_share(shares: NDArray[np.float64]) -> float:
    """Return the mean visible share of all sections (8,) except the feet."""
    return float(np.add.reduce(shares[:FEET])) / FEET


def _fill_ellipse(image: NDArray[np.uint8], x: float, y: float, a: float, b: float) -> None:
    centre, axes = (round(x * _SCALE), round(y * _SCALE)), (round(a * _SCALE), round(b * _SCALE))
    cv2.ellipse(image, centre, axes, 0, 0, 360, COVERED, cv2.FILLED, cv2.LINE_8, _SUBPIXEL_BITS)
