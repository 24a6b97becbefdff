"""The scene model: confirmed layers, people by temperature or shape, objects and their changes."""

import itertools
import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.pose2 import Pose2
from peopleboy.tracker.frame import DEPTH, Frame
from peopleboy.tracker.scene_model.geometry import Geometry, shades_of
from peopleboy.tracker.scene_model.happenings import Ledger
from peopleboy.tracker.scene_model.layers import Layers
from peopleboy.tracker.scene_model.readings import Readings
from peopleboy.tracker.scene_model.scene import (
    Change,
    Happening,
    Labels,
    Metres,
    ObjectState,
    Place,
    SceneObject,
    ScenePerson,
    VistaScene,
)
from peopleboy.tracker.scene_model.scene_config import SceneConfig
from peopleboy.tracker.scene_model.scene_people import People, PeopleSeen
from peopleboy.tracker.scene_model.things import (
    Thing,
    ThingMoment,
    ThingPieces,
    opened,
    pieces_like,
    standing,
)
from peopleboy.tracker.scene_model.vista_spaces import StaticMap, Surface

# Colours of surfaces that are no longer visible.

Colours = NDArray[np.uint8]


class PastColours:
    """Stores the colours of the background, and of the former background."""

    def __init__(self) -> None:
        self._now: Colours | None = None
        self._past: Colours | None = None

    def update(self, colour: Colours | None, layers: Layers, time_s: float) -> Colours | None:
        """Add the (H, W, C) colours of a frame after its readings are assigned; return the past colours.

        Returns:
            (H, W, C); None without colours.
        """
        if colour is None:
            return None
        if self._now is None or self._past is None:
            self._now, self._past = colour.copy(), colour.copy()
            return self._past
        has_opened = layers.is_opened(time_s)
        self._past[has_opened] = self._now[has_opened]
        np.copyto(self._now, colour, where=(layers.back_seen_s == np.float32(time_s))[:, :, None])
        return self._past


class SceneModel:
    """Learns the background of a place, which objects were moved, and who moved them.

    Args:
        config: settings.
    """

    def __init__(self, config: SceneConfig) -> None:
        self.config = config
        self._people = People(config.people)
        self._ledger = Ledger(config.things)
        self._ids = itertools.count(1)
        self._geometry: Geometry | None = None
        self._map = StaticMap(joins=config.joins)
        self._pose = Pose2()
        self._vista = -1
        self._stopped_s = -math.inf
        self._newest: VistaScene | None = None
        self._readings: Readings | None = None

    def update(self, frame: Frame) -> VistaScene:
        """Process the next frame.

        While the robot moves, and for a moment after, learning is paused; then a new place begins.

        Raises:
            BadInput: there is no depth image of the previous size, or no calibration, or no odometry.
        """
        geometry = self._geometry_of(frame)
        if not self._stands(frame):
            assert self._newest is not None  # the first frame is standing
            return replace(
                self._newest, time_s=frame.time_s, is_frozen=True, happenings=(), persons=(),
                people=np.zeros_like(self._newest.people), things=np.zeros_like(self._newest.things),
            )  # fmt: skip
        self._newest = self._learned(frame, geometry)
        return self._newest

    def finish(self) -> tuple[Happening, ...]:
        """Return the delayed changes, at the end."""
        if self._newest is None:
            return ()
        return tuple(self._known(one) for one in self._ledger.finished(self._newest.time_s))

    def static_map(self) -> Surface:
        """Return the surface seen from all places so far.

        Raises:
            BadInput: there was no frame yet.
        """
        if self._vista < 0:
            raise BadInput("the scene model has seen nothing yet")
        if self._stopped_s == -math.inf:
            self._pose = self._added()
        assert self._map.surface is not None  # something was added
        return self._map.surface

    @property
    def geometry(self) -> Geometry:
        """Geometry of the depth camera; there must have been a frame."""
        assert self._geometry is not None
        return self._geometry

    @property
    def pose(self) -> Pose2:
        """Pose of the robot, in the frame of the first place."""
        return self._pose

    def _stands(self, frame: Frame) -> bool:
        """Integrate the odometry, and return whether the robot has been standing for long enough to learn.

        Raises:
            BadInput: the motion is unknown.
        """
        config, way = self.config, frame.odometry
        if self._vista < 0:
            self._begin(frame.depth(DEPTH).shape)
            return True
        if way is None:
            raise BadInput(
                f"{frame.time_s:g} s: the scene model needs odometry to detect whether the robot stands"
            )
        is_moving = (
            math.hypot(way.advance_m, way.aside_m) > config.still_m or abs(way.turn_rad) > config.still_rad
        )
        if is_moving and self._stopped_s == -math.inf:
            self._pose = self._added()
        if is_moving or self._stopped_s != -math.inf:  # odometry of a standing robot is noise
            self._pose = self._pose.compose(way.motion)
        if is_moving:
            self._stopped_s = math.inf
        elif self._stopped_s == math.inf:
            self._stopped_s = frame.time_s
        if self._stopped_s == -math.inf:
            return True
        if frame.time_s - self._stopped_s < config.still_s:
            return False
        self._begin(frame.depth(DEPTH).shape)
        return True

    def _added(self) -> Pose2:
        """Add the surface of the current place to the map."""
        assert self._newest is not None  # there was a frame
        return self._map.add(Surface.of(self._newest.background_m, self.geometry), self._pose)

    def _learned(self, frame: Frame, geometry: Geometry) -> VistaScene:
        config, layers = self.config, self._layers
        readings = Readings.of(frame.depth(DEPTH), self._readings, config.layers.memory)
        self._readings = readings
        reach = readings.reach_m(config.layers.least_m, config.layers.deviations, config.layers.most_m)
        people = self._people.update(frame, geometry, readings, layers, reach)
        layers.take_in(readings, reach, people.ignored, frame.time_s, config.layers.confirm)
        happenings = self._happenings(frame, geometry, people)
        return self._scene(frame.time_s, readings, reach, people, happenings)

    def _geometry_of(self, frame: Frame) -> Geometry:
        shape = frame.depth(DEPTH).shape
        if self._geometry is None or self._geometry.calibration is not frame.calibrations.get(DEPTH):
            self._geometry = Geometry.of(frame)
        if shape != self._geometry.shape or (self._vista >= 0 and shape != self._layers.shape):
            raise BadInput(f"{DEPTH} image must be {self._layers.shape} as the ones before, got {shape}")
        return self._geometry

    def _begin(self, shape: tuple[int, int]) -> None:
        """Reset the state for a new place."""
        self._vista += 1
        self._stopped_s = -math.inf
        self._layers = Layers(*shape)
        self._standing = ThingPieces(self.config.things, shape)
        self._opened = ThingPieces(self.config.things, shape)
        self._readings = None
        self._colours = PastColours()
        self._people.forget_places()

    def _happenings(self, frame: Frame, geometry: Geometry, people: PeopleSeen) -> tuple[Happening, ...]:
        config = self.config.things
        colour = shades_of(frame)
        moment = ThingMoment(frame.time_s, geometry, colour)
        self._ledger.note(frame.time_s, people.persons)
        come, left = self._standing.update(*standing(self._layers, config), moment, self._ids)
        behind = ThingMoment(frame.time_s, geometry, self._colours.update(colour, self._layers, frame.time_s))
        through, _ = self._opened.update(*opened(self._layers, config), behind, self._ids)
        unseen = self._standing.unseen(frame.time_s)
        happenings = self._ledger.reported(frame.time_s, come, [*left, *through], unseen)
        for one in happenings:
            if one.change is Change.MOVED:
                self._rename(one)
        return tuple(happenings)

    def _rename(self, moved: Happening) -> None:
        """Give an object that appeared the id of one that disappeared."""
        for number, thing in list(self._standing.things.items()):
            if thing.place_m == moved.to_m and number != moved.object:
                self._standing.things.pop(moved.object, None)
                self._standing.rename(number, moved.object)

    def _scene(
        self,
        time_s: float,
        readings: Readings,
        reach: NDArray[np.float32],
        people: PeopleSeen,
        happenings: tuple[Happening, ...],
    ) -> VistaScene:
        layers = self._layers
        is_seen = layers.is_covered & (np.abs(readings.smooth_m - layers.front_m) < reach)
        is_seen &= people.labels == 0
        things = np.where(is_seen, self._standing.owner, 0)
        self._label_carried(things, readings, reach, people)
        return VistaScene(
            time_s=time_s,
            background_m=layers.surface_m(readings.noise),
            people=people.labels,
            things=things,
            persons=tuple(self._placed(one) for one in people.persons),
            objects=tuple(self._object(one, things) for one in self._standing.things.values()),
            happenings=tuple(self._known(one) for one in happenings),
            vista=self._vista,
        )

    def _label_carried(self, things: Labels, readings: Readings, reach: Metres, people: PeopleSeen) -> None:
        """Label the last disappeared object in a person's hands."""
        config = self.config.things
        missing = self._opened.newest() or self._ledger.missing()
        if missing is None or not people.persons:
            return
        mask = self._layers.is_before(readings.smooth_m, np.maximum(reach, np.float32(config.off_m)))
        mask &= (readings.smooth_m > 0.0) & ~people.ignored & (things == 0)
        for points, pixels in pieces_like(missing, mask, readings.smooth_m, self.geometry, config):
            if any(math.dist(one.place_m, points) < config.hand_m for one in people.persons):
                things.ravel()[pixels] = missing.id

    def _placed(self, person: ScenePerson) -> ScenePerson:
        return replace(person, place_m=self._pose.transform_point(person.place_m))

    def _known(self, one: Happening) -> Happening:
        return replace(one, from_m=self._in_first(one.from_m), to_m=self._in_first(one.to_m))

    def _in_first(self, place_m: Place | None) -> Place | None:
        return None if place_m is None else (*self._pose.transform_point(place_m[:2]), place_m[2])

    def _object(self, thing: Thing, things: Labels) -> SceneObject:
        is_seen = bool((things == thing.id).any())
        state = ObjectState.GONE if thing.is_gone else ObjectState.STANDS if is_seen else ObjectState.HIDDEN
        place = self._in_first(thing.place_m)
        assert place is not None  # it has one
        return SceneObject(
            id=thing.id,
            box=thing.box,
            place_m=place,
            size_m2=thing.size_m2,
            first_seen_s=thing.span_s[1],
            state=state,
        )
