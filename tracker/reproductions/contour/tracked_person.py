"""State of a tracked person between two frames, and its update."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.reproductions.contour.appearance.appearance_model import ColourModel
from peopleboy.tracker.reproductions.contour.box_interaction import PERSON_M, regions_of, shared_parts
from peopleboy.tracker.reproductions.contour.contour_config import LifeConfig, SmoothingConfig, TrackerConfig
from peopleboy.tracker.reproductions.contour.particle_filter import Belief, FrameView
from peopleboy.tracker.reproductions.contour.particles import FOOT, STATE_SIZE, VX, D, H, W, X, Y
from peopleboy.tracker.track import Status

SETTLED = 6  # frames
SIZE = [W, H, D]  # columns of a state
HEIGHT = 3.7  # height of people, in body semi-heights
VELOCITY_S = 0.4  # time constant of the velocity with which an occluded person continues
FOOT_S = 0.5
FORGET_S = 10.0  # time after which an occluded person is forgotten
Value = TypeVar("Value", float, NDArray[np.float64])


@dataclass(frozen=True, slots=True, eq=False)
class TrackedPerson:
    """A tracked person between two frames.

    Attributes:
        id: 1 or more.
        born_s: time of the first frame [s].
        belief: posterior of its filter.
        shown: (9,) estimate, smoothed over time; for an occluded person, the assumed state.
        velocity: (2,) of its position, smoothed over a longer time [px/s].
        foot: row of its feet [px], smoothed, when last fully visible.
        size: (3,) its w, h and d [px], smoothed, when last fully visible.
        seen_frames: number of frames in which it was fully visible.
        missing: consecutive frames in which the person was not seen.
        status: visibility.
        occluder: id of the person who occludes it, at least partly.
        is_behind: whether people in front explain why it is not seen.
        hidden_frames: number of frames for which it has been occluded.
        hidden_s: time for which it has been occluded [s].
        appearance: learned descriptor, with which its samples are compared; None before the first one.
        is_unidentified: whether it may still be a person who was lost.
    """

    id: int
    born_s: float
    belief: Belief
    shown: NDArray[np.float64]
    velocity: NDArray[np.float64]
    foot: float
    size: NDArray[np.float64]
    seen_frames: int = 0
    missing: int = 0
    status: Status = Status.TRACKED
    occluder: int | None = None
    is_behind: bool = False
    hidden_frames: int = 0
    hidden_s: float = 0.0
    appearance: ColourModel | None = None
    is_unidentified: bool = False

    @property
    def is_settled(self) -> bool:
        """Whether it was visible for long enough to be remembered."""
        return self.seen_frames >= SETTLED

    @property
    def is_hidden(self) -> bool:
        """Whether it is completely invisible."""
        return self.status is Status.TOTALLY_OCCLUDED


def is_born(belief: Belief, view: FrameView, config: LifeConfig) -> bool:
    """Return whether a detector has settled on a person: it fits the image, and the samples agree.

    Source: thesis, section 4.2: mean of equation 4.4 above 0.5 and equation 4.6 below its threshold.
    """
    return is_sure(belief, view, config.birth_confidence, config)


def is_sure(belief: Belief, view: FrameView, confidence: float, config: LifeConfig) -> bool:
    """Return whether a filter's samples agree on a person above a confidence."""
    return belief.confidence > confidence and _agrees(belief, view, config)


@dataclass(frozen=True, slots=True)
class Streak:
    """Number of consecutive frames in which the detector was certain of an untracked person.

    The same confidence means more for some contours than for others. Contours a few pixels high fit two
    people side by side nearly as well as one of them, and next to a near person, an arm resembles a smaller
    person. A large contour without a neighbour is hardly ever wrong.

    Attributes:
        frames: with the confidence required for people of that size.
        clear_frames: with the confidence required for a large person without a neighbour.
    """

    frames: int = 0
    clear_frames: int = 0

    @property
    def is_some(self) -> bool:
        """Whether there are any."""
        return self.frames > 0 or self.clear_frames > 0

    def is_enough(self, config: TrackerConfig) -> bool:
        """Return whether a track is initiated."""
        return self.frames >= config.life.birth_frames or self.clear_frames >= config.search.clear_frames

    def after(
        self, belief: Belief, known: Sequence[NDArray[np.float64]], view: FrameView, config: TrackerConfig
    ) -> "Streak":
        """Update with the detector's posterior of one more frame.

        Args:
            belief: posterior of the detector.
            known: (9,) states of all people who are tracked or remembered, or their assumed states.
            view: the frame.
            config: settings of the tracker.
        """
        search = config.search
        is_small = belief.estimate[H] < search.small_h * view.size
        least = search.small_confidence if is_small else config.life.birth_confidence
        is_clear = (
            not is_small
            and is_sure(belief, view, search.clear_confidence, config.life)
            and not _is_beside(belief.estimate, known, config)
        )
        return Streak(
            frames=self.frames + 1 if is_sure(belief, view, least, config.life) else 0,
            clear_frames=self.clear_frames + 1 if is_clear else 0,
        )


def is_kept(belief: Belief, view: FrameView, config: LifeConfig) -> bool:
    """Return whether a tracked person is still visible.

    Source: thesis, section 5.1: a filter is deleted when its mean is smaller than 0.5 or its uncertainty too
    large.
    """
    return belief.confidence >= config.death_confidence and _agrees(belief, view, config)


def _agrees(belief: Belief, view: FrameView, config: LifeConfig) -> bool:
    """Compare the spread with its threshold, an area that is proportional to the squared image size."""
    return belief.uncertainty_px2 < config.uncertainty_px2 * view.size**2


def _is_beside(
    found: NDArray[np.float64], known: Sequence[NDArray[np.float64]], config: TrackerConfig
) -> bool:
    """Return whether a person (9,) overlaps the widened regions of known people (9,)."""
    around = regions_of(known, config)
    margin = config.search.clear_margin * around[:, 2]
    around[:, 0] -= margin
    around[:, 2] += 2 * margin
    return bool((shared_parts(regions_of([found], config), around) > 0).any())


def initiate_person(
    number: int, belief: Belief, view: FrameView, time_s: float, config: TrackerConfig
) -> TrackedPerson:
    """Initiate a track from the posterior of a filter."""
    state = belief.estimate
    appearance = _learned(None, state, view, config)
    return TrackedPerson(
        number, time_s, belief, state, np.zeros(2), _foot_of(state), state[SIZE], appearance=appearance
    )


def approached(person: TrackedPerson, view: FrameView) -> TrackedPerson:
    """Scale the stored state of a standing person as the camera approaches."""
    if view.advance_m == 0:
        return person
    distance_m = view.mount.focal_px * PERSON_M / (HEIGHT * max(float(person.size[1]), 1.0))
    growth = distance_m / max(distance_m - view.advance_m, 0.5 * distance_m)
    horizon = view.mount.horizon_px
    return replace(person, size=growth * person.size, foot=horizon + growth * (person.foot - horizon))


def moved_on(state: NDArray[np.float64], view: FrameView) -> NDArray[np.float64]:
    """Predict a state (9,) of the last frame by its velocity and the camera's rotation."""
    later = state.copy()
    later[:4] += view.dt_s * later[VX:]
    later[X] = view.column_after_turn(float(later[X]))
    return later


def hidden(person: TrackedPerson, view: FrameView) -> TrackedPerson:
    """Count one more frame in which a person is invisible."""
    return replace(
        person,
        status=Status.TOTALLY_OCCLUDED,
        missing=0,
        hidden_frames=person.hidden_frames + 1,
        hidden_s=person.hidden_s + view.dt_s,
    )


def seen(
    person: TrackedPerson, belief: Belief, occluder: int | None, view: FrameView, config: TrackerConfig
) -> TrackedPerson:
    """Update a person with a frame in which it is not occluded.

    Args:
        person: state after the last frame.
        belief: posterior of its filter in this frame.
        occluder: id of a person in front who overlaps it; None if there is none.
        view: this frame.
        config: settings of the tracker.
    """
    missing = 0 if is_kept(belief, view, config.life) else person.missing + 1
    status = Status.TRACKED if occluder is None else Status.PARTLY_OCCLUDED
    moved: dict[str, Any] = {
        "belief": belief,
        "shown": smoothed(person.shown, belief.estimate, view, config.smoothing),
        "status": Status.TENTATIVE if missing >= config.life.doubt_frames else status,
        "occluder": occluder,
        "is_behind": occluder is not None,
        "missing": missing,
        "hidden_frames": 0,
        "hidden_s": 0.0,
    }
    if missing > 0 or occluder is not None:
        return replace(person, **moved)
    before = person.belief.estimate[:2].copy()
    before[X] = view.column_after_turn(float(before[X]))
    speed = (belief.estimate[:2] - before) / view.dt_s
    return replace(
        person,
        **moved,
        appearance=_learned(person.appearance, belief.estimate, view, config),
        seen_frames=person.seen_frames + 1,
        velocity=_blend(person.velocity, speed, max(view.dt_s / VELOCITY_S, 1 / (person.seen_frames + 1))),
        foot=_blend(person.foot, _foot_of(belief.estimate), view.dt_s / FOOT_S),
        size=_blend(person.size, belief.estimate[SIZE], view.dt_s / config.height.memory_s),
    )


def smoothed(
    before: NDArray[np.float64], now: NDArray[np.float64], view: FrameView, config: SmoothingConfig
) -> NDArray[np.float64]:
    """Blend the estimate (9,) of this frame into the previous output: a first-order low pass against jitter.

    The previous output is first moved by the estimated velocity and the camera's rotation, so that a steady
    walk has no lag. A person's size changes slowly, and may be smoothed for longer than the position.
    """
    expected = moved_on(before, view)
    return expected + _gains(view.dt_s, config.place_s, config.size_s) * (now - expected)


@lru_cache(maxsize=8)
def _gains(dt_s: float, place_s: float, size_s: float) -> NDArray[np.float64]:
    """Return the weight (9,) of a new state after a time step, by the time constants."""
    gain = np.ones(STATE_SIZE)
    gain[[X, Y]] = _gain(dt_s, place_s)
    gain[SIZE] = _gain(dt_s, size_s)
    return gain


def _gain(dt_s: float, time_constant_s: float) -> float:
    return 1.0 if time_constant_s == 0 else 1 - math.exp(-dt_s / time_constant_s)


def _learned(
    known: ColourModel | None, state: NDArray[np.float64], view: FrameView, config: TrackerConfig
) -> ColourModel | None:
    """Update the appearance of a fully visible person with this state (9,).

    Source: thesis, sections 6.1.3 and 7.4, by which the model is not updated during occlusions.
    """
    features = None if config.colour is None else view.describe(state.astype(np.float32)[None])
    if config.colour is None or features is None:
        return known
    return ColourModel.begin(features[0], config.colour) if known is None else known.updated(features[0])


def _foot_of(state: NDArray[np.float64]) -> float:
    """Return the row of a person's feet [px]."""
    return float(state[Y] + FOOT * state[H])


def _blend(before: Value, now: Value, share: float) -> Value:
    """Move a smoothed value by a share of the difference."""
    return before + min(share, 1.0) * (now - before)
