"""Our way with hidden people: they walk on, are looked for, and are shown while that is sure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.contour.appearance.appearance_model import squared_distances
from peopleboy.tracker.contour.box_interaction import Regions, overlap_shares
from peopleboy.tracker.contour.contour_config import MotionConfig, TrackerConfig, WalkOnConfig
from peopleboy.tracker.contour.gallery import is_comparable, least_mismatch
from peopleboy.tracker.contour.measurement.likelihood import body_share, head_share, probability, seen_shares
from peopleboy.tracker.contour.occlusion.depth_order import OrderContext
from peopleboy.tracker.contour.particle_filter import Belief, FrameView
from peopleboy.tracker.contour.particles import FOOT, VW, VX, VY, D, H, W, X, Y, equally_weighted
from peopleboy.tracker.contour.tracked_person import (
    FORGET_S,
    SIZE,
    TrackedPerson,
    approached,
    hidden,
    moved_on,
    seen,
    smoothed,
)

# When a person is hidden, and seen again.
HEAD_COVERED = 0.8  # share of the head's contour behind others from which a person is hidden
HIDDEN_BODY = 0.4  # least share of the contour by which a person with a covered head is still followed
LOST_FRAMES = 3  # frames without evidence after which a person counts as hidden by something unknown
CLEAR = 0.5  # share of head and body in view from which a hidden person may be seen again
CLAIMED = 0.5  # share of its region that another person must have left free
APPEARANCE_GATE = 40.0  # largest squared distance of appearance of who comes back to sight
SIZE_GATE = 0.25  # largest change of the logarithm of its height
# How the hidden walk: people seldom stop or turn, keep to the floor, and keep their size.
MEMORY = 0.985  # share of the velocity that lasts to the next step
ALONG_FLOOR = 0.5  # share of the motion noise along the floor
STIFFNESS = 0.1  # the same for all other directions and the size
WIDTH = 0.46  # semi-width in semi-heights: who is hidden may turn
FADING = 0.96  # share of the velocity that lasts once nobody looks for the person any more
SEARCHED_FRAMES = 45  # frames in the open for which samples look for it
# How long they are shown [s]: hidden by nobody known; on the way out of the image; behind a person, if the
# samples are farther apart than this share of the semi-width. Others are until they are forgotten.
SHOWN_S, SHOWN_LEAVING_S, SHOWN_BEHIND_S, SURE_SPREAD = 0.3, 0.5, 0.8, 0.4


@dataclass(frozen=True, slots=True)
class CoastingVisibility:
    """What can be seen of a person at its estimate.

    Attributes:
        head: share of the head's contour that is in view.
        body: share of the whole contour.
        confidence: probability by what is in view alone.
        is_free: whether nobody else is seen there.
        is_alike: whether what is in view has the person's height, and its appearance as far as it is known.
    """

    head: float
    body: float
    confidence: float
    is_free: bool
    is_alike: bool

    @property
    def is_clear(self) -> bool:
        """Whether most of the right person is in view."""
        return min(self.head, self.body) > CLEAR and self.is_alike and self.is_free


class WalkOn:
    """Who is hidden, or lost, walks on along the floor with the velocity and the size that it had."""

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
        """Let a hidden person walk on along the floor, and keep its size."""
        return self._hidden_motion if person.is_hidden else self._config.motion

    def keeps_off(self, person: TrackedPerson) -> bool:  # noqa: ARG002
        """Penalise the hidden too, or they would come back as a person who is not in front."""
        return True

    def judge(
        self,
        person: TrackedPerson,
        belief: Belief,
        surroundings: OrderContext,
        view: FrameView,
        rng: np.random.Generator,
    ) -> TrackedPerson:
        """Judge by what is in view; who is hidden walks on, and is seen again once most of it is."""
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
        """Take a person as seen; where the image does not speak for it, it is shown walking on."""
        after = seen(person, belief, occluder, view, self._config)
        if after.missing == 0:
            return after
        walking = np.concatenate([person.shown[:VX], person.velocity, (0.0, 0.0)])
        return replace(after, shown=moved_on(walking, view))

    def _supposed(
        self, person: TrackedPerson, belief: Belief, surroundings: OrderContext, view: FrameView
    ) -> NDArray[np.float64]:
        """Suppose where a hidden person is (9,): it walks on, as tall as it was, on the floor as before."""
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
        """Look for a person as long as it was not missed too often where it would have been seen."""
        return person.missing < SEARCHED_FRAMES

    def remembers_lost(self, person: TrackedPerson) -> bool:
        """Remember who was seen for long enough."""
        return self._hiding.remembers_lost and person.is_settled

    def whereabouts(
        self,
        person: TrackedPerson,
        others: Sequence[TrackedPerson],  # noqa: ARG002
        view: FrameView,
    ) -> NDArray[np.float64]:
        """Let a person walk on, slower and slower."""
        state = moved_on(person.shown, view)
        state[VW:] = 0.0
        state[VX:] *= FADING
        return state

    def can_compare(self, found: TrackedPerson, lost: TrackedPerson) -> bool:
        """Wait until most is seen of what is known of the one who was lost."""
        return is_comparable(found, lost)

    def recognised(
        self, found: TrackedPerson, lost: Sequence[TrackedPerson], view: FrameView
    ) -> TrackedPerson | None:
        """Return the one of the lowest cost, if that is low enough."""
        return least_mismatch(found, lost, view, self._config)

    def is_shown(self, person: TrackedPerson, region: Regions, view: FrameView) -> bool:
        """Show a hidden person as long as it is fairly certain where it is."""
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
    """Judge a person by what is in view of it alone."""
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
    """Return which share of a person's head, and of all of it, those in front leave in view."""
    if not surroundings.front:
        return 1.0, 1.0
    shares = seen_shares(surroundings.image, belief.estimate, view.model.probes)
    return head_share(shares), body_share(shares)


def _is_behind(state: NDArray[np.float64], surroundings: OrderContext, view: FrameView) -> bool:
    """Return whether people in front explain why a person with this state (9,) is not seen."""
    if not surroundings.front:
        return False
    return body_share(seen_shares(surroundings.image, state, view.model.probes)) < HIDDEN_BODY


def _walking_on(person: TrackedPerson, rng: np.random.Generator) -> TrackedPerson:
    """Start the samples of a person who has just been hidden from where it is shown, with its velocity."""
    shown = person.shown.copy()
    shown[VX:] = [*person.velocity, 0.0, 0.0]
    size = float(shown[H])
    spread = np.zeros(9)
    spread[[X, Y, W, H, D]] = 0.15 * size, 0.05 * size, 0.03 * size, 0.05 * size, 0.05 * size
    spread[[VX, VY]] = 0.25 * float(np.hypot(*person.velocity)) + 0.3 * size, 0.1 * size
    chance = rng.standard_normal((len(person.belief.particles), 9))
    cloud = equally_weighted((shown + spread * chance).astype(np.float32))
    return replace(person, belief=replace(person.belief, particles=cloud), shown=shown)
