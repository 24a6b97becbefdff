"""The scene model that is used: confirmed layers, people by heat or shape, things, and what happens to them."""

from __future__ import annotations

import itertools
import math

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, Frame
from peopleboy.tracker.scene_model.geometry import Geometry
from peopleboy.tracker.scene_model.past_colours import PastColours
from peopleboy.tracker.scene_model.happenings import Ledger
from peopleboy.tracker.scene_model.layers import Layers, take_in
from peopleboy.tracker.scene_model.people import People, PeopleSeen
from peopleboy.tracker.scene_model.readings import Readings
from peopleboy.tracker.scene_model.scene import Change, Happening, Scene, SceneObject, State
from peopleboy.tracker.scene_model.scene_config import SceneConfig
from peopleboy.tracker.scene_model.things import Moment, Pieces, Thing, opened, standing


class SceneModel:
    """Learns what stands in a place, what was moved there, and by whom.

    Args:
        config: settings.
    """

    def __init__(self, config: SceneConfig) -> None:
        self.config = config
        self._people = People(config.people)
        self._ledger = Ledger(config.things)
        self._ids = itertools.count(1)
        self._geometry: Geometry | None = None
        self._readings: Readings | None = None
        self._vista = -1

    def update(self, frame: Frame) -> Scene:
        """Take in the next frame.

        Raises:
            BadInput: no depth image of the size of the ones before, or no calibration.
        """
        geometry = self._geometry_of(frame)
        if self._vista < 0:
            self._begin(geometry.shape)
        config, layers = self.config, self._layers
        readings = Readings.of(frame.depth(DEPTH), self._readings, config.layers.memory)
        self._readings = readings
        reach = readings.reach_m(config.layers.least_m, config.layers.deviations, config.layers.most_m)
        people = self._people.update(frame, geometry, readings, layers, reach)
        take_in(
            layers, readings, reach, people.ignored, frame.time_s, config.layers.confirm
        )
        happenings = self._happenings(frame, geometry, people)
        return self._scene(frame.time_s, readings, reach, people, happenings)

    def _geometry_of(self, frame: Frame) -> Geometry:
        shape = frame.depth(DEPTH).shape
        if self._geometry is None:
            self._geometry = Geometry.of(frame)
        elif self._geometry.calibration is not frame.calibrations.get(DEPTH):
            self._geometry = Geometry.of(frame)
        if shape != self._geometry.shape or (self._vista >= 0 and shape != self._layers.back.shape):
            raise BadInput(f"{DEPTH} image must be {self._layers.back.shape} as the ones before, got {shape}")
        return self._geometry

    def _begin(self, shape: tuple[int, int]) -> None:
        """Know nothing of a new place."""
        self._vista += 1
        self._layers = Layers.of_size(*shape)
        self._standing = Pieces(self.config.things, shape)
        self._opened = Pieces(self.config.things, shape)
        self._readings = None
        self._colours = PastColours()
        self._people.forget_places()

    def _happenings(self, frame: Frame, geometry: Geometry, people: PeopleSeen) -> tuple[Happening, ...]:
        config = self.config.things
        colour = frame.rgb(DEPTH_COLOUR) if DEPTH_COLOUR in frame.images else None
        moment = Moment(frame.time_s, geometry, colour)
        self._ledger.note(frame.time_s, people.persons)
        come, left = self._standing.update(*standing(self._layers, config), moment, self._ids)
        behind = Moment(frame.time_s, geometry, self._colours.update(colour, self._layers, frame.time_s))
        through, _ = self._opened.update(*opened(self._layers, config), behind, self._ids)
        happenings = self._ledger.told(frame.time_s, come, [*left, *through])
        for one in happenings:
            if one.change is Change.MOVED:
                self._rename(one)
        return tuple(happenings)

    def _rename(self, moved: Happening) -> None:
        """Give a thing that appeared the id of what vanished."""
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
    ) -> Scene:
        layers = self._layers
        front = np.where(layers.front_count > 0.0, layers.front, np.float32(1e9))
        is_seen = (np.abs(readings.smooth_m - 1.0 / front) < reach) & (people.labels == 0)
        things = np.where(is_seen, self._standing.owner, 0)
        return Scene(
            time_s=time_s,
            background_m=layers.surface_m,
            people=people.labels,
            things=things,
            persons=people.persons,
            objects=tuple(_object(one, things) for one in self._standing.things.values()),
            happenings=happenings,
            vista=self._vista,
        )


def _object(thing: Thing, things: NDArray[np.int32]) -> SceneObject:
    state = State.GONE if thing.is_gone else State.STANDS
    return SceneObject(
        id=thing.id,
        box=thing.box,
        place_m=thing.place_m,
        size_m2=thing.size_m2,
        first_seen_s=thing.span_s[1],
        state=state,
    )
