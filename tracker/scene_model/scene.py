"""Output of a scene model: background, people, movable objects, and their changes."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.track import Box

Metres = NDArray[np.float32]
Labels = NDArray[np.int32]
Place = tuple[float, float, float]


class ObjectState(StrEnum):
    """Whether a movable object is present."""

    STANDS = "stands"
    HIDDEN = "hidden"
    GONE = "gone"


class Change(StrEnum):
    """Kinds of changes of objects."""

    APPEARED = "appeared"
    VANISHED = "vanished"
    MOVED = "moved"


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneObject:
    """A movable object: it was put in front of the background, or removed from it.

    Attributes:
        id: from 1 on.
        box: left, top, width, height [px] of the depth image.
        place_m: its middle, forward and left of the robot's first pose, and up from the floor [m].
        size_m2: visible area, facing the camera [m^2].
        first_seen_s: time of the first observation [s].
        state: whether it is present.
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
        id: from 1 on, constant while the person is tracked.
        place_m: position on the floor, forward and left of the robot's first pose [m].
    """

    id: int
    place_m: tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Happening:
    """A change of an object.

    Attributes:
        time_s: time of the change [s]: the middle of the interval without observations.
        known_s: time at which the model was certain [s].
        change: kind of the change.
        object: id of the object.
        from_m: previous position [m]; None if unknown.
        to_m: new position [m]; None if it is not visible.
        person: id of the person nearby, or None.
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
        """Distance moved [m]; 0 if one of the positions is unknown."""
        if self.from_m is None or self.to_m is None:
            return 0.0
        return float(np.linalg.norm(np.subtract(self.to_m, self.from_m)))


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class VistaScene:
    """The scene after one more frame.

    Attributes:
        time_s: of the frame [s].
        background_m: (H, W) depth of the background, along the optical axis [m]; 0 where unknown.
        people: (H, W) ids of the people in the image; 0 for none.
        things: (H, W) ids of the visible movable objects; 0 for none.
        persons: people in the image.
        objects: all movable objects, including removed ones.
        happenings: changes that became certain in this frame.
        is_frozen: whether learning is paused because the robot moves.
        vista: number of the robot's standing position, from 0.
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
