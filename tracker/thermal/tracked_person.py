"""What is kept of a person between two frames."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.thermal.appearance.colour_model import ColourModel
from peopleboy.tracker.thermal.filter.particles import VX, D, H, W, X
from peopleboy.tracker.thermal.particle_filter import Belief, FrameView
from peopleboy.tracker.track import Status

SETTLED = 6  # frames
SIZE = [W, H, D]  # columns of a state
PERSON_M = 1.72  # height of people [m]
HEIGHT = 3.7  # the same, in body semi-heights


@dataclass(frozen=True, slots=True, eq=False)
class TrackedPerson:
    """A tracked person between two frames.

    Attributes:
        id: 1 or more.
        born_s: time of the first frame [s].
        belief: its filter.
        shown: (9,) its estimate, smoothed over time; of a hidden person, where it is supposed to be.
        velocity: (2,) of its place, smoothed over a longer time [px/s].
        foot: row of its feet [px], smoothed, as last seen whole.
        size: (3,) its w, h and d [px], smoothed, as last seen whole.
        seen_frames: in how many frames it was seen whole.
        missing: frames in a row in which the person was not seen.
        status: how well it is seen.
        occluder: id of the person who hides it, or part of it.
        is_behind: whether those in front explain why it is not seen.
        hidden_frames: for how many frames it has been hidden.
        hidden_s: for how long it has been hidden [s].
        colour: its colours of late; None until they were seen.
        appearance: colours and thermal pattern of late; None until they were seen.
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
    colour: ColourModel | None = None
    appearance: ColourModel | None = None

    @property
    def is_settled(self) -> bool:
        """Whether it was seen for long enough to be worth remembering."""
        return self.seen_frames >= SETTLED

    @property
    def is_hidden(self) -> bool:
        """Whether nothing of it is seen."""
        return self.status is Status.TOTALLY_OCCLUDED


def approached(person: TrackedPerson, view: FrameView) -> TrackedPerson:
    """Let what is kept of a standing person grow as the camera comes nearer."""
    distance_m = view.focal_px * PERSON_M / (HEIGHT * max(float(person.size[1]), 1.0))
    growth = distance_m / max(distance_m - view.advance_m, 0.5 * distance_m)
    horizon = (view.image.shape[0] - 1) / 2
    return replace(person, size=growth * person.size, foot=horizon + growth * (person.foot - horizon))


def moved_on(state: NDArray[np.float64], view: FrameView) -> NDArray[np.float64]:
    """Move a state (9,) of the last frame to this one, by its velocity and the camera's turn."""
    later = state.copy()
    later[:4] += view.dt_s * later[VX:]
    later[[X]] = view.after_turn(later[[X]])
    return later
