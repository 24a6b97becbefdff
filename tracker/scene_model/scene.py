"""What a scene model reports: background, people, movable things, and what happened to them."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.track import Box

Metres = NDArray[np.float32]
Labels = NDArray[np.int32]
Place = tuple[float, float, float]


class ObjectState(StrEnum):
    """Where a movable thing is."""

    STANDS = "stands"
    HIDDEN = "hidden"
    GONE = "gone"


class Change(StrEnum):
    """What happens to things."""

    APPEARED = "appeared"
    VANISHED = "vanished"
    MOVED = "moved"


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneObject:
    """A movable thing: it was put in front of the background, or taken away from it.

    Attributes:
        id: from 1 on.
        box: left, top, width, height [px] of the depth image.
        place_m: its middle, forward and left of where the robot stood first, and up from the floor [m].
        size_m2: area of its visible surface, seen from the camera [m^2].
        first_seen_s: when [s].
        state: where it is.
    """

    id: int
    box: Box
    place_m: Place
    size_m2: float
    first_seen_s: float
    state: ObjectState


@dataclass(frozen=True, slots=True, kw_only=True)
class ScenePerson:
    """A person in the depth image.

    Attributes:
        id: from 1 on; the same one as long as a person is followed.
        place_m: on the floor, forward and left of where the robot stood first [m].
    """

    id: int
    place_m: tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Happening:
    """Something that happened to a thing.

    Attributes:
        time_s: when [s]: the middle of the time in which nobody saw the place.
        known_s: when the model was sure [s].
        change: what.
        object: whose id.
        from_m: where it was [m]; None if it was not seen before.
        to_m: where it is [m]; None if it is not seen any more.
        person: id of who was there; None for nobody.
    """

    time_s: float
    known_s: float
    change: Change
    object: int
    from_m: Place | None = None
    to_m: Place | None = None
    person: int | None = None

    @property
    def way_m(self) -> float:
        """How far it moved [m]; 0 where one of the ends is not known."""
        if self.from_m is None or self.to_m is None:
            return 0.0
        return float(np.linalg.norm(np.subtract(self.to_m, self.from_m)))


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class VistaScene:
    """A place after one more frame.

    Attributes:
        time_s: of the frame [s].
        background_m: (H, W) depth of what stands, along the optical axis [m]; 0 where it was never seen.
        people: (H, W) ids of the people in the image; 0 for nobody.
        things: (H, W) ids of the movable things that are seen now; 0 for none.
        persons: who is there.
        objects: every movable thing, those that are gone, too.
        happenings: what the model became sure of with this frame.
        is_frozen: whether the robot moves, so that nothing is learned.
        vista: number of the standing place, from 0.
    """

    time_s: float
    background_m: Metres
    people: Labels
    things: Labels
    persons: tuple[ScenePerson, ...] = ()
    objects: tuple[SceneObject, ...] = ()
    happenings: tuple[Happening, ...] = ()
    is_frozen: bool = False
    vista: int = 0
