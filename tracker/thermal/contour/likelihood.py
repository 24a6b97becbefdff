"""How likely a sample is, given the image: from section differences to weight and probability."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.thermal.config import (
    REFERENCE_HEIGHT_PX,
    ContourConfig,
    FilterConfig,
    LikelihoodConfig,
    LimitsConfig,
)
from peopleboy.tracker.thermal.contour.contour import (
    FEET,
    Probes,
    build_probes,
    build_response,
    person_grey,
    section_differences,
    section_weights,
)
from peopleboy.tracker.thermal.filter.particles import D, Floats, H, W, Y, normalised


@dataclass(frozen=True, slots=True, eq=False)
class ContourModel:
    """A contour laid out for one image size; build it once, use it for every frame.

    Attributes:
        shape: (H, W) of the images it is for.
        config: where it came from.
        probes: the points to look at.
        response: (8, 511) what a difference of grey counts.
        weights: (8,) of the sections.
    """

    shape: tuple[int, int]
    config: ContourConfig
    probes: Probes
    response: Floats
    weights: NDArray[np.float64]

    @classmethod
    def build(cls, shape: tuple[int, int], config: ContourConfig) -> ContourModel:
        """Lay the contour out for images of (H, W) pixels."""
        size = shape[0] / REFERENCE_HEIGHT_PX
        return cls(shape, config, build_probes(config, size), build_response(config), section_weights(config))

    def prepare(self, thermal: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Turn a thermal image (H, W) into the one that the contour is compared with."""
        return person_grey(thermal, self.config)

    def differences(self, image: NDArray[np.uint8], state: Floats, covered: float | None = None) -> Floats:
        """Measure every section of every sample in a prepared image, (N, 8).

        Args:
            image: (H, W) prepared.
            state: (N, 9) samples.
            covered: what a point counts where the image says that somebody is in front; None if it does not.
        """
        unseen = self.config.unseen_response
        result = section_differences(image, state, self.probes, self.response, unseen, covered)
        if self.config.feet_weight > 0:
            result[:, FEET] = np.minimum(1.0, self.config.feet_gain * result[:, FEET])
        return result


def fitness(differences: Floats, weights: NDArray[np.float64], config: LikelihoodConfig) -> Floats:
    """Sum up how well each sample fits the image, (N,), from its section differences (N, 8).

    Source: thesis, equation 4.3; paper, equations 3 and 4, where the plain sum of the differences is
    multiplied by the weight of those sections that reach a threshold. The paper's sum is divided by the
    number of sections here, so that both fitnesses are grey levels and share one threshold.
    """
    if config.model == "thesis":
        total: Floats = differences @ weights.astype(np.float32)
        if config.weakest_share > 0:
            # By columns: numpy is slow in finding the least of a few numbers many times.
            weakest = np.array(differences[:, :FEET].T, order="C").min(axis=0)
            total += np.float32(config.weakest_share) * (weakest - total)
        return total
    strong = (differences >= config.section_threshold) @ weights.astype(np.float32)
    used = int((weights > 0).sum())
    product: Floats = strong * (differences.sum(axis=1) / np.float32(used))
    return product


def probability(fit: Floats, config: LikelihoodConfig) -> Floats:
    """Scale a fitness (N,) to 0..1; 0.5 at the threshold.

    Source: thesis, equation 4.4, which equals the logistic function of 2 kappa (f - theta).
    """
    # Beyond +-40 the result no longer changes, and exp would overflow.
    exponent = np.clip(np.float32(2 * config.slope) * (fit - np.float32(config.threshold)), -40, 40)
    result: Floats = 1 / (1 + np.exp(-exponent))
    return result


def sample_weights(
    fit: Floats, chance: Floats, is_inside: NDArray[np.bool_], model: str, config: FilterConfig
) -> Floats:
    """Weigh the samples (N,), to sum to 1.

    The thesis weighs with the probability, which is flat once the fitness is well above the threshold; with a
    sharpness, the weight goes on growing with the fitness. The paper weighs with the fitness itself.

    Source: thesis, equation 4.5; paper, equation 3.
    """
    if config.sharpness > 0:
        weight = np.exp(config.sharpness * (fit - fit.max()))
    elif model == "paper":
        weight = np.maximum(fit, 1e-6)
    else:
        weight = chance
    return normalised(
        np.where(is_inside, weight, np.float32(config.limits.outside_weight) * weight).astype(np.float32)
    )


def is_within(state: Floats, height_px: int, limits: LimitsConfig) -> NDArray[np.bool_]:
    """Tell which samples (N,) have a person's proportions and place.

    Source: thesis, section 4.2 and the table of section 4.4.
    """
    w, h = state[:, W], state[:, H]
    below_horizon = state[:, Y] - limits.horizon * height_px
    return (
        (w > limits.ratio_wh[0] * h)
        & (w < limits.ratio_wh[1] * h)
        & (state[:, D] > limits.ratio_dw[0] * w)
        & (state[:, D] < limits.ratio_dw[1] * w)
        & (state[:, Y] > limits.y[0] * height_px)
        & (state[:, Y] < limits.y[1] * height_px)
        & (below_horizon > limits.y_below_horizon[0] * h)
        & (below_horizon < limits.y_below_horizon[1] * h)
        & (h > limits.h[0] * height_px)
        & (h < limits.h[1] * height_px)
    )
