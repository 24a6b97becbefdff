"""Coasting of occluded people: they keep walking, are searched for, and are output while that is certain."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.reproductions.contour.appearance.appearance_model import squared_distances
from peopleboy.tracker.reproductions.contour.box_interaction import Regions, overlap_shares
from peopleboy.tracker.reproductions.contour.contour_config import MotionConfig, TrackerConfig, WalkOnConfig
from peopleboy.tracker.reproductions.contour.gallery import is_comparable, least_mismatch
from peopleboy.tracker.reproductions.contour.measurement.likelihood import (
    body_share,
    head_share,
    probability,
    seen_shares,
)
from peopleboy.tracker.reproductions.contour.occlusion.depth_order import OrderContext
from peopleboy.tracker.reproductions.contour.particle_filter import Belief, FrameView
from peopleboy.tracker.reproductions.contour.particles import (
    FOOT,
    VW,
    VX,
    VY,
    D,
    H,
    W,
    X,
    Y,
    equally_weighted,
)
from peopleboy.tracker.reproductions.contour.tracked_person import (
    FORGET_S,
    SIZE,
    TrackedPerson,
    approached,
    hidden,
    moved_on,
    seen,
    smoothed,
)

# Conditions of occlusion and reappearance.
HEAD_COVERED = 0.8  # covered share of the head's contour from which a person is occluded
HIDDEN_BODY = 0.4  # least visible share of the contour for tracking a person with a covered head
LOST_FRAMES = 3  # frames without evidence after which a person counts as occluded by an unknown object
CLEAR = 0.5  # visible share of head and body from which an occluded person can be found again
CLAIMED = 0.5  # share of its region that must not be covered by another person
APPEARANCE_GATE = 40.0  # greatest squared distance of appearance of a reappearing person
SIZE_GATE = 0.25  # greatest change of the logarithm of its height
# Motion of occluded people: they seldom stop or turn, stay on the floor, and keep their size.
MEMORY = 0.985  # share of the velocity that persists to the next step
ALONG_FLOOR = 0.5  # share of the motion noise along the floor
STIFFNESS = 0.1  # the same for all other directions and the size
WIDTH = 0.46  # semi-width in semi-heights: occluded people may turn
FADING = 0.96  # share of the velocity that persists once the person is no longer searched for
SEARCHED_FRAMES = 45  # frames without an occluder for which the samples search
# Longest output [s]: without a known occluder; while leaving the image; behind a person, if the
# samples are farther apart than this share of the semi-width. Otherwise until they are forgotten.
SHOWN_S, SHOWN_LEAVING_S, SHOWN_BEHIND_S, SURE_SPREAD = 0.3, 0.5, 0.8, 0.4


@dataclass(frozen=True, slots=True)
class CoastingVisibility:
    """Visibility of a person at its estimate.

    Attributes:
        head: visible share of the head's contour.
        body: visible share of the whole contour.
        confidence: probability by the visible part alone.
        is_free: whether no other person is detected there.
        is_alike: whether the visible part has the person's height, and its appearance if known.
    """

    head: float
    body: float
    confidence: float
    is_free: bool
    is_alike: bool

    @property
    def is_clear(self) -> bool:
        """Whether most of the right person is visible."""
        return min(self.head, self.body) > CLEAR and self.is_alike and self.is_free


class WalkOn:
    """Occluded or lost people keep walking along the floor with their last velocity and size."""

    def __init__(self, config: TrackerConfig, hiding: WalkOnConfig) -> None:
        self._config = config
        self._hiding = hiding
        motion = config.motion
        self._hidden_motion = replace(
            motion,
            noise_x=ALONG_FLOOR * motion.noise_x,
            noise_y=STIFFNESS * motion.noise_y,
            noise_w=STIFFNESS * motion.noise_w,
            noise_h=STIFFNESS * motion.noise_h,
            noise_d=STIFFNESS * motion.noise_d,
            place_memory=MEMORY,
        )

    def motion_of(self, person: TrackedPerson) -> MotionConfig:
        """Restrict an occluded person's motion to the floor, with constant size."""
        return self._hidden_motion if person.is_hidden else self._config.motion

    def keeps_off(self, person: TrackedPerson) -> bool:  # noqa: ARG002
        """Penalise occluded people, too, or they would reappear on a person who is not in front."""
        return True

    def judge(
        self,
        person: TrackedPerson,
        belief: Belief,
        surroundings: OrderContext,
        view: FrameView,
        rng: np.random.Generator,
    ) -> TrackedPerson:
        """Evaluate the visible part; an occluded person coasts until most of it is visible again."""
        person = approached(person, view)
        front = surroundings.occluder(belief.estimate, self._config)
        occluder = None if front is None else front.id
        if person.is_hidden:
            visibility = look_at(person, belief, surroundings, view, self._config)
            if visibility.is_clear and visibility.confidence > self._config.life.birth_confidence:
                return self._seen(person, belief, occluder, view)
            missing = person.missing + (visibility.head > CLEAR)
            shown = self._supposed(person, belief, surroundings, view)
            return replace(
                hidden(person, view),
                belief=belief,
                shown=shown,
                missing=missing,
                occluder=occluder,
                is_behind=_is_behind(shown, surroundings, view),
            )
        after = self._seen(person, belief, occluder, view)
        head, body = _in_view(belief, surroundings, view)
        is_covered = head <= 1 - HEAD_COVERED and body < HIDDEN_BODY
        is_lost = self._hiding.remembers_lost and after.missing >= LOST_FRAMES
        if (surroundings.front and is_covered) or (is_lost and person.is_settled):
            return _walking_on(replace(hidden(after, view), occluder=occluder), rng)
        return after

    def _seen(
        self, person: TrackedPerson, belief: Belief, occluder: int | None, view: FrameView
    ) -> TrackedPerson:
        """Update a visible person; without evidence in the image, the output is the prediction."""
        after = seen(person, belief, occluder, view, self._config)
        if after.missing == 0:
            return after
        walking = np.concatenate([person.shown[:VX], person.velocity, (0.0, 0.0)])
        return replace(after, shown=moved_on(walking, view))

    def _supposed(
        self, person: TrackedPerson, belief: Belief, surroundings: OrderContext, view: FrameView
    ) -> NDArray[np.float64]:
        """Predict the state (9,) of an occluded person: it walks on the floor with constant height."""
        if surroundings.front:
            shown = smoothed(person.shown, belief.estimate, view, self._config.smoothing)
        else:
            shown = moved_on(person.shown, view)
            shown[VX : VX + 2] *= MEMORY
        shown[SIZE] = person.size
        shown[W] = WIDTH * shown[H]
        shown[Y] = person.foot - FOOT * shown[H]
        return shown

    def searches(self, person: TrackedPerson) -> bool:
        """Keep searching unless the person was missed too often where it would have been visible."""
        return person.missing < SEARCHED_FRAMES

    def remembers_lost(self, person: TrackedPerson) -> bool:
        """Remember people who were visible for long enough."""
        return self._hiding.remembers_lost and person.is_settled

    def whereabouts(
        self,
        person: TrackedPerson,
        others: Sequence[TrackedPerson],  # noqa: ARG002
        view: FrameView,
    ) -> NDArray[np.float64]:
        """Predict the person with decreasing speed."""
        state = moved_on(person.shown, view)
        state[VW:] = 0.0
        state[VX:] *= FADING
        return state

    def can_compare(self, found: TrackedPerson, lost: TrackedPerson) -> bool:
        """Wait until most of the lost person's known appearance is visible."""
        return is_comparable(found, lost)

    def recognised(
        self, found: TrackedPerson, lost: Sequence[TrackedPerson], view: FrameView
    ) -> TrackedPerson | None:
        """Return the person of the lowest cost, if that is low enough."""
        return least_mismatch(found, lost, view, self._config)

    def is_shown(self, person: TrackedPerson, region: Regions, view: FrameView) -> bool:
        """Output an occluded person as long as its position is fairly certain."""
        longest = self._shown_s(person, region, view) if self._hiding.shows_only_sure else FORGET_S
        return person.hidden_s <= longest

    def _shown_s(self, person: TrackedPerson, region: Regions, view: FrameView) -> float:
        if person.is_behind:
            is_sure = person.belief.uncertainty_px2 < (SURE_SPREAD * float(person.shown[W])) ** 2
            return FORGET_S if is_sure else SHOWN_BEHIND_S
        left, top, width, height = region
        rows, columns = view.image.shape
        walks_out = (left < 0 and person.velocity[0] < 0) or (
            left + width > columns and person.velocity[0] > 0
        )
        return SHOWN_LEAVING_S if walks_out and top + height < rows else SHOWN_S


def look_at(
    person: TrackedPerson, belief: Belief, surroundings: OrderContext, view: FrameView, config: TrackerConfig
) -> CoastingVisibility:
    """Evaluate a person by its visible part alone."""
    rows = belief.estimate.astype(np.float32)[None]
    head, body = _in_view(belief, surroundings, view)
    covered = 0.0 if surroundings.front else None
    differences = view.model.differences(surroundings.image, rows, covered, covered_share=0.0)
    fit = np.add.reduce(differences[0] * view.model.weights)
    chance = float(probability(np.array([fit], dtype=np.float32), config.likelihood)[0])
    features, away = view.describe(rows, surroundings.hiding), np.nan
    if person.appearance is not None and features is not None:
        away = float(squared_distances(features, person.appearance)[0])
    growth = abs(np.log(max(belief.estimate[H], 1.0) / max(person.shown[H], 1.0)))
    is_alike = growth < SIZE_GATE and not away > APPEARANCE_GATE
    is_free = not (overlap_shares(rows, surroundings.rivals, config) > CLAIMED).any()
    return CoastingVisibility(head, body, chance, is_free, is_alike)


def _in_view(belief: Belief, surroundings: OrderContext, view: FrameView) -> tuple[float, float]:
    """Return the shares of a person's head, and of all of it, not covered by people in front."""
    if not surroundings.front:
        return 1.0, 1.0
    shares = seen_shares(surroundings.image, belief.estimate, view.model.probes)
    return head_share(shares), body_share(shares)


def _is_behind(state: NDArray[np.float64], surroundings: OrderContext, view: FrameView) -> bool:
    """Return whether people in front explain why a person with this state (9,) is not visible."""
    if not surroundings.front:
        return False
    return body_share(seen_shares(surroundings.image, state, view.model.probes)) < HIDDEN_BODY


def _walking_on(person: TrackedPerson, rng: np.random.Generator) -> TrackedPerson:
    """Restart the samples of a newly occluded person at its output state, with its velocity."""
    shown = person.shown.copy()
    shown[VX:] = [*person.velocity, 0.0, 0.0]
    size = float(shown[H])
    spread = np.zeros(9)
    spread[[X, Y, W, H, D]] = 0.15 * size, 0.05 * size, 0.03 * size, 0.05 * size, 0.05 * size
    spread[[VX, VY]] = 0.25 * float(np.hypot(*person.velocity)) + 0.3 * size, 0.1 * size
    chance = rng.standard_normal((len(person.belief.particles), 9))
    cloud = equally_weighted((shown + spread * chance).astype(np.float32))
    return replace(person, belief=replace(person.belief, particles=cloud), shown=shown)
