"""One particle filter: predict, weigh, estimate, resample."""

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.camera_mount import Mount, mount_of
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame, Odometry
from peopleboy.tracker.reproductions.contour.appearance.appearance_model import AppearanceView, visible
from peopleboy.tracker.reproductions.contour.appearance.colour_view import ColourView
from peopleboy.tracker.reproductions.contour.box_interaction import Regions
from peopleboy.tracker.reproductions.contour.contour_config import (
    REFERENCE_HEIGHT_PX,
    FilterConfig,
    MotionConfig,
    TrackerConfig,
)
from peopleboy.tracker.reproductions.contour.measurement.likelihood import ContourModel, fitness, probability
from peopleboy.tracker.reproductions.contour.particles import (
    CameraTurn,
    D,
    Floats,
    H,
    Particles,
    W,
    Y,
    camera_turn,
    draw_prior,
    estimated,
    floor_rows,
    limits_px,
    predict,
    resample,
    turned,
)
from peopleboy.tracker.reproductions.contour.weights import NOTHING, shared_out, sharp_weights

STANDING = Odometry()
OUTSIDE_WEIGHT = 1e-6  # factor on the weight of a sample outside the limits: "a very low chance"


@dataclass(frozen=True, slots=True, eq=False)
class FrameView:
    """One frame as input of the filters.

    Attributes:
        image: (H, W) preprocessed grey image.
        model: contour model for the image's size.
        dt_s: time since the last frame [s].
        turn_rad: rotation of the camera since then, left positive [rad]; 0 if unknown.
        mount: of the camera.
        advance_m: forward motion of the camera since then [m]; 0 if unknown.
        colour: the colour image; None without one.
        appearance: colours and thermal pattern together; None if not used.
        covered: response of contour points where a person in front is marked in the image; None if there are
            no marks.
    """

    image: NDArray[np.uint8]
    model: ContourModel
    dt_s: float
    turn_rad: float
    mount: Mount
    colour: ColourView | None = None
    appearance: AppearanceView | None = None
    covered: float | None = None
    advance_m: float = 0.0

    @property
    def size(self) -> float:
        """Image height / 240."""
        return int(self.image.shape[0]) / REFERENCE_HEIGHT_PX

    @property
    def turn(self) -> CameraTurn:
        """The camera's rotation since the last frame, in terms of image columns."""
        return camera_turn(self.turn_rad, self.mount.focal_px, (self.image.shape[1] - 1) / 2)

    def column_after_turn(self, x: float) -> float:
        """Return the present column of a column x [px] of the last frame, without people's own motion."""
        return turned(x, self.turn)

    def describe(self, state: Floats, hiding: Regions | None = None) -> Floats | None:
        """Describe the appearance of people (N, 9), (N, F); None if not available.

        NaN for parts behind people with regions (M, 4).
        """
        source = self.colour if self.appearance is None else self.appearance
        if source is None:
            return None
        features = source.describe(state)
        return features if hiding is None else visible(features, state, hiding)


def view_frame(
    frame: Frame, dt_s: float, model: ContourModel, config: TrackerConfig, mount: Mount | None = None
) -> FrameView:
    """Prepare a frame for all filters; without a given mount, it is taken from the calibration."""
    motion = config.motion
    moved = frame.odometry if motion.uses_odometry and frame.odometry is not None else STANDING
    thermal = frame.grey(THERMAL)
    if mount is None:
        mount = mount_of(frame.calibrations.get(THERMAL), len(thermal))
    image = model.prepare(thermal)
    colour = None
    if config.colour is not None and COLOUR in frame.images:
        colour = ColourView.build(frame.rgb(COLOUR), thermal.shape, config.colour)
    appearance = None if config.appearance is None else AppearanceView.build(image, colour, config.appearance)
    return FrameView(image, model, dt_s, moved.turn_rad, mount, colour, appearance, advance_m=moved.advance_m)


@dataclass(frozen=True, slots=True, eq=False)
class Belief:
    """Posterior of a filter after one frame.

    Attributes:
        particles: the weighted samples, before resampling.
        core: the samples that form the estimate.
        estimate: (9,) state, the core's mean.
        confidence: 0..1, the core's mean probability.
        uncertainty_px2: the core's spread over x and y [px^2].
    """

    particles: Particles
    core: Particles
    estimate: NDArray[np.float64]
    confidence: float
    uncertainty_px2: float


def weigh(
    state: Floats,
    view: FrameView,
    filter_config: FilterConfig,
    config: TrackerConfig,
    factor: Floats | None = None,
    likeness: Floats | None = None,
) -> Belief:
    """Weigh samples (N, 9) by the image, and estimate the person from them.

    Args:
        state: (N, 9) samples.
        view: the image.
        filter_config: settings of this filter.
        config: settings of the tracker.
        factor: (N,) on the weights, to avoid other people; None for 1.
        likeness: (N,) likelihood of the appearance; None for 1.

    Source: thesis, algorithm 3 (update), equations 4.2 and 4.6; 5.1 and 5.2 with the factor, 6.17 with the
    likeness.
    """
    differences = view.model.differences(view.image, state, view.covered)
    fit = fitness(differences, view.model.weights, config.likelihood)
    chance = probability(fit, config.likelihood)
    inside = is_within(state, limits_px(view.image.shape[0], filter_config.limits))
    if likeness is not None and filter_config.sharpness == 0:
        factor = likeness if factor is None else likeness * factor
    weight = sample_weights(fit, chance, inside, config.likelihood.model, filter_config, factor, likeness)
    choice = filter_config.estimate_share, filter_config.estimate_reach
    own, heavy, estimate, confidence, uncertainty_px2 = estimated(state, weight, chance, inside, choice)
    core = Particles(own, heavy)
    return Belief(Particles(state, weight), core, estimate, confidence, uncertainty_px2)


def sample_weights(
    fit: Floats,
    chance: Floats,
    is_inside: NDArray[np.bool_],
    model: str,
    config: FilterConfig,
    factor: Floats | None = None,
    likeness: Floats | None = None,
) -> Floats:
    """Return the weights of the samples (N,), which sum to 1.

    The thesis uses the probability as the weight, which saturates well above the threshold; with a sharpness,
    the weight keeps growing with the fitness plus the logarithm of the likeness. The paper uses the fitness
    itself.

    Source: thesis, equation 4.5; paper, equation 3.
    """
    if config.sharpness > 0:
        weight = sharp_weights(fit, NOTHING if likeness is None else likeness, config.sharpness, config.floor)
    elif model == "paper":
        weight = np.maximum(np.maximum(fit, np.float32(config.floor)), np.float32(1e-6))
    else:
        weight = chance
    weighed: Floats = shared_out(weight, is_inside, NOTHING if factor is None else factor, OUTSIDE_WEIGHT)
    return weighed


@njit(cache=True, nogil=True)
def is_within(state: Floats, limits: Floats) -> NDArray[np.bool_]:
    """Return which samples (N, 9) are within the limits `limits_px` of proportions and position.

    Checks w / h, d / w, y and h, and y against the floor.

    Source: thesis, section 4.2 and the table of section 4.4.
    """
    inside = np.empty(len(state), dtype=np.bool_)
    is_anywhere = np.isinf(limits[9]) and np.isinf(limits[10])
    for i in range(len(state)):
        y, w, h, d = state[i, Y], state[i, W], state[i, H], state[i, D]
        inside[i] = (
            (w > limits[0] * h)
            & (w < limits[1] * h)
            & (d > limits[2] * w)
            & (d < limits[3] * w)
            & (y > limits[4])
            & (y < limits[5])
            & (h > limits[6])
            & (h < limits[7])
        )
        if not is_anywhere:
            above, below = floor_rows(h, limits)
            inside[i] &= (y > above) & (y < below)
    return inside


def step(
    particles: Particles,
    view: FrameView,
    filter_config: FilterConfig,
    config: TrackerConfig,
    rng: np.random.Generator,
) -> Belief:
    """Advance a filter from the last frame to this one.

    The weighted samples of the last frame are resampled first instead of last. The cycle is the same, but
    between two frames a caller holds the weighted samples before resampling.

    Source: thesis, algorithm 3.
    """
    return weigh(advance(particles, view, filter_config, config, rng), view, filter_config, config)


def advance(
    particles: Particles,
    view: FrameView,
    filter_config: FilterConfig,
    config: TrackerConfig,
    rng: np.random.Generator,
    motion: MotionConfig | None = None,
    resizes: bool = True,
) -> Floats:
    """Draw the samples (N, 9) of this frame from those of the last one, and a share from the prior.

    Args:
        particles: samples of the last frame.
        view: this frame.
        filter_config: settings of this filter.
        config: settings of the tracker.
        rng: random generator.
        motion: motion model; None for the tracker's own.
        resizes: whether the filter's share of samples is resized.
    """
    fresh = round(filter_config.fresh_share * filter_config.count)
    kept = resample(particles, filter_config.count - fresh, rng)
    motion = config.motion if motion is None else motion
    share = filter_config.resized_share if resizes else 0.0
    moved = predict(particles.state, kept, view.dt_s, view.turn, view.size, motion, rng, share)
    if fresh == 0:
        return moved
    return np.concatenate([moved, draw_fresh(fresh, view, filter_config, config, rng)])


def begin(
    view: FrameView, filter_config: FilterConfig, config: TrackerConfig, rng: np.random.Generator
) -> Belief:
    """Start a filter on samples from the prior."""
    return weigh(
        draw_fresh(filter_config.count, view, filter_config, config, rng), view, filter_config, config
    )


def draw_fresh(
    count: int, view: FrameView, filter_config: FilterConfig, config: TrackerConfig, rng: np.random.Generator
) -> Floats:
    """Draw samples (count, 9) from the prior for this image."""
    return draw_prior(count, view.image.shape, config.motion, filter_config, rng)
