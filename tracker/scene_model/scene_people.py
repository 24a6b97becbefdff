"""Detection of people in a depth image: by temperature, or by shape and motion outside the thermal image."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.frame import Floats, Frame
from peopleboy.tracker.scene_model.connected_pieces import Bools, Pixels, pieces_of, pixels_by_label
from peopleboy.tracker.scene_model.geometry import COLD, UNSEEN, WARM, Geometry
from peopleboy.tracker.scene_model.layers import Layers
from peopleboy.tracker.scene_model.readings import Readings
from peopleboy.tracker.scene_model.scene import Labels, Metres, ScenePerson
from peopleboy.tracker.scene_model.scene_config import PeopleMaskConfig

_CROSS = cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))
_AROUND = np.ones((3, 3), np.uint8)
_SAME_M = 0.45  # between parts of one body separated by an occluder
_LOWEST_HUMAN_M = 0.9  # top of a warm component before the background is known
_HIGHEST_FOOT_M = 1.6
_WIDEST_M = 1.1
_HEAD_M = 0.35
_HALF = 0.5
_FEWEST_PX = 10


@dataclass(frozen=True, slots=True, eq=False)
class BodyPiece:
    """A connected component of the image that may belong to a person.

    Attributes:
        pixels: (N,) flat indices.
        points_m: (N, 3) in the robot frame.
        is_warm: whether it is a person by the thermal image.
    """

    pixels: Pixels
    points_m: Floats
    is_warm: bool

    @property
    def place_m(self) -> Floats:
        """Its middle (2,) on the floor."""
        return np.asarray(np.median(self.points_m[:, :2], axis=0))

    @property
    def top_m(self) -> float:
        """Its height above the floor, without the highest pixels."""
        return float(np.quantile(self.points_m[:, 2], 0.98))

    @property
    def width_m(self) -> float:
        """Its width, without the outermost pixels."""
        low, high = np.quantile(self.points_m[:, 1], [0.03, 0.97])
        return float(high - low)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Follower:
    """A tracked person, or an object of a person's shape.

    Attributes:
        id: 0 until it is confirmed as a person.
        place_m: (2,) position on the floor.
        first_m: (2,) first position.
        born_s, seen_s: times of the first and the last observation.
    """

    id: int
    place_m: Floats
    first_m: Floats
    born_s: float
    seen_s: float


@dataclass(frozen=True, slots=True, eq=False)
class PeopleSeen:
    """People in a frame.

    Attributes:
        labels: (H, W) ids; 0 for none.
        ignored: (H, W) where nothing is learned of the scene: people, and candidates.
        persons: visible people.
    """

    labels: Labels
    ignored: Bools
    persons: tuple[ScenePerson, ...]


class People:
    """Detects and tracks people.

    Args:
        config: settings.
    """

    def __init__(self, config: PeopleMaskConfig) -> None:
        self._config = config
        self._known: tuple[Follower, ...] = ()
        self._last_id = 0

    def forget_places(self) -> None:
        """Forget all positions, after the robot has moved."""
        self._known = ()

    def update(
        self, frame: Frame, geometry: Geometry, readings: Readings, layers: Layers, reach_m: Metres
    ) -> PeopleSeen:
        """Detect the people of a frame, before the scene is learned from it."""
        smooth = readings.smooth_m
        background = layers.background_m
        is_known = layers.is_known
        is_off = (smooth > 0.0) & (~is_known | (np.abs(smooth - background) > reach_m))
        heat = geometry.warmth(smooth, frame, self._config.warm) if self._config.has_heat else None
        warmth = np.full(geometry.shape, UNSEEN, np.int8) if heat is None else heat
        pieces = [
            *self._warm_pieces(is_off, is_known, warmth, geometry, smooth),
            *self._shapes((warmth == UNSEEN) & (smooth > 0.0), layers, geometry, smooth, reach_m),
        ]
        return self._followed(pieces, geometry, frame.time_s)

    def _warm_pieces(
        self, is_off: Bools, is_known: Bools, warmth: NDArray[np.int8], geometry: Geometry, smooth: Metres
    ) -> Iterable[BodyPiece]:
        """Return warm components; before the background is known, only those of human size."""
        seeds = is_off & (warmth == WARM)
        if not seeds.any():
            return
        grown = _grown(seeds, is_off & is_known & (warmth == COLD), smooth, self._config)
        labels, count = pieces_of(grown, smooth, self._config.gap_m)
        for _, pixels in pixels_by_label(labels, count):
            piece = self._piece(pixels, geometry, smooth, is_warm=True)
            if piece is not None and (is_known.ravel()[pixels].mean() > 0.5 or _is_human(piece)):
                yield piece

    def _shapes(
        self, is_unseen: Bools, layers: Layers, geometry: Geometry, smooth: Metres, reach_m: Metres
    ) -> Iterable[BodyPiece]:
        """Return components with the shape of a person, except known objects."""
        is_thing = np.abs(smooth - layers.front_m) < reach_m
        background = layers.background_m
        is_off = np.abs(smooth - background) > np.maximum(reach_m, self._config.clear_m)
        is_off &= is_unseen & layers.is_settled
        is_nearer = smooth < background
        labels, count = pieces_of(is_off & ~is_thing, smooth, self._config.gap_m)
        rest, people = [], []
        for _, pixels in pixels_by_label(labels, count):
            piece = self._piece(pixels, geometry, smooth, is_warm=False)
            if piece is None:
                continue
            has_opened = bool(is_nearer.ravel()[pixels].mean() < _HALF)
            person = None if has_opened else self._human(piece)
            if person is None:
                rest.append(piece)
            else:
                people.append(person)
        yield from people
        for piece in rest:
            yield from self._columns(piece, people)

    def _piece(
        self, pixels: Pixels, geometry: Geometry, smooth: Metres, *, is_warm: bool
    ) -> BodyPiece | None:
        depth = smooth.ravel()[pixels]
        if float((depth**2).sum()) / geometry.focal_px**2 < self._config.least_m2:
            return None
        return BodyPiece(pixels, geometry.points(pixels, smooth), is_warm)

    def _human(self, piece: BodyPiece) -> BodyPiece | None:
        """Return the part below the head of a component of human size, without touched objects."""
        config, across = self._config, piece.points_m[:, :2]
        if piece.top_m < config.top_m or piece.width_m > config.wide_m:
            return None
        axis = np.median(across[piece.points_m[:, 2] > piece.top_m - _HEAD_M], axis=0)
        return _within(piece, np.hypot(*(across - axis).T) < config.wide_m / 2.0)

    def _columns(self, piece: BodyPiece, people: Sequence[BodyPiece]) -> Iterable[BodyPiece]:
        """Return the columns of known people in a component that does not have human size.

        Only the part below people who are already detected is theirs.
        """
        config, across = self._config, piece.points_m[:, :2]
        found = [person.place_m for person in people]
        for one in self._known:
            way = np.hypot(*(across - one.place_m).T)
            axis, radius = one.place_m, config.column_m
            own = min(found, key=lambda place: math.dist(place, one.place_m), default=None)
            if own is not None and math.dist(own, one.place_m) < config.gate_m:
                axis, radius = own, config.below_m
            else:
                is_high = (way < config.gate_m) & (piece.points_m[:, 2] > config.top_m - _HEAD_M)
                if is_high.sum() >= _FEWEST_PX:
                    axis = np.median(across[is_high], axis=0)
            is_own = np.hypot(*(across - axis).T) < radius
            if is_own.sum() >= _FEWEST_PX:
                yield _within(piece, is_own)

    def _followed(self, pieces: Sequence[BodyPiece], geometry: Geometry, time_s: float) -> PeopleSeen:
        """Assign every component to a person."""
        config = self._config
        labels, ignored = np.zeros(geometry.shape, np.int32), np.zeros(geometry.shape, np.uint8)
        known = [one for one in self._known if time_s - one.seen_s < config.kept_s]
        seen: dict[int, list[BodyPiece]] = {}
        for piece in sorted(pieces, key=lambda one: -len(one.pixels)):
            owner = self._owner(piece, known, seen, time_s)
            if owner is None:
                place = piece.place_m
                known.append(Follower(id=0, place_m=place, first_m=place, born_s=time_s, seen_s=time_s))
                owner = len(known) - 1
            seen.setdefault(owner, []).append(piece)
        persons = []
        for k, own in seen.items():
            known[k] = one = self._moved(known[k], own, time_s)
            pixels = np.concatenate([piece.pixels for piece in own])
            if one.id or time_s - one.born_s < config.doubt_s:
                ignored.flat[pixels] = 1
            if one.id:
                labels.flat[pixels] = one.id
                x, y = one.place_m.tolist()
                persons.append(ScenePerson(id=one.id, place_m=(x, y)))
        self._known = tuple(known)
        return PeopleSeen(labels, cv2.dilate(ignored, _AROUND) > 0, tuple(persons))

    def _owner(
        self, piece: BodyPiece, known: Sequence[Follower], seen: dict[int, list[BodyPiece]], time_s: float
    ) -> int | None:
        config, place = self._config, piece.place_m
        ways = {}
        for k, one in enumerate(known):
            way = float(np.hypot(*(place - one.place_m)))
            gate = _SAME_M if k in seen else config.gate_m + config.gate_m_s * min(time_s - one.seen_s, 1.0)
            if k in seen:
                way = min(float(np.hypot(*(place - other.place_m))) for other in seen[k])
            if way < gate:
                ways[k] = way
        return min(ways, key=lambda k: ways[k], default=None)

    def _moved(self, one: Follower, pieces: Sequence[BodyPiece], time_s: float) -> Follower:
        points = np.concatenate([piece.points_m for piece in pieces])
        place = np.asarray(np.median(points[:, :2], axis=0))
        is_person = (
            any(piece.is_warm for piece in pieces) or math.dist(place, one.first_m) > self._config.moved_m
        )
        if not one.id and is_person:
            self._last_id += 1
            return replace(one, id=self._last_id, place_m=place, seen_s=time_s)
        return replace(one, place_m=place, seen_s=time_s)


def _within(piece: BodyPiece, is_own: Bools) -> BodyPiece:
    return BodyPiece(piece.pixels[is_own], piece.points_m[is_own], piece.is_warm)


def _is_human(piece: BodyPiece) -> bool:
    """Return whether a warm component can be a human; radiators, lamps and windows cannot."""
    foot = float(np.quantile(piece.points_m[:, 2], 0.02))
    return piece.top_m > _LOWEST_HUMAN_M and foot < _HIGHEST_FOOT_M and piece.width_m < _WIDEST_M


def _grown(seeds: Bools, cold: Bools, depth_m: Metres, config: PeopleMaskConfig) -> Bools:
    """Grow warm regions over connected cold pixels."""
    grown = seeds.astype(np.uint8)
    for _ in range(config.grown_px):
        nearest = cv2.dilate(np.where(grown > 0, depth_m, np.float32(0.0)), _CROSS)
        grown |= (cold & (nearest > 0.0) & (np.abs(nearest - depth_m) < config.gap_m)).astype(np.uint8)
    return np.asarray(grown > 0)
