"""Movable objects: components in front of the background, or of a former background."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.frame import Floats
from peopleboy.tracker.scene_model.connected_pieces import (
    Bools,
    Pixels,
    PixelSpan,
    pieces_of,
    pixels_by_label,
)
from peopleboy.tracker.scene_model.geometry import Geometry
from peopleboy.tracker.scene_model.layers import NEVER, Layers
from peopleboy.tracker.scene_model.scene import Labels, Metres, Place
from peopleboy.tracker.scene_model.scene_config import ThingsConfig
from peopleboy.tracker.track import Box

Colours = NDArray[np.uint8]

_AROUND = np.ones((3, 3), np.uint8)
_COMPACT: Final = 0.2  # share of an object's pixels not at its edge; edges of walls have nothing else
_FEWEST_PX: Final = 8  # of a part of a known object
_COVERED: Final = 0.5  # share of an object's pixels
_OWN: Final = 0.3  # share of a component that an object must have had to keep it


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Thing:
    """A component of the image that changed at one time.

    Attributes:
        id: id of the object.
        box: left, top, width, height [px].
        pixels: current number.
        most: greatest number so far.
        where: (N,) their flat indices at the last measurement.
        depth_m: median of their depths then [m].
        place_m: its middle in the robot frame [m].
        size_m2: area facing the camera [m^2].
        height_m: from the lowest to the highest point [m].
        top_m: highest point above the floor [m].
        colour: (3,) mean RGB, or (1,) mean reflectance; None without either.
        span_s: interval of its change [s].
        seen_s: time of the last observation [s].
        steady_s, steady_px: start of the time without growth, and its pixels then.
        settled_s, settled_px: when it had been unchanged for long enough, and its pixels then.
        is_gone: whether it disappeared.
    """

    id: int
    box: Box
    pixels: int
    most: int
    where: Pixels
    depth_m: float
    place_m: Place
    size_m2: float
    height_m: float
    top_m: float
    colour: Floats | None
    span_s: tuple[float, float]
    seen_s: float
    steady_s: float
    steady_px: int
    settled_s: float = math.inf
    settled_px: int = 0
    is_gone: bool = False

    @property
    def is_settled(self) -> bool:
        """Whether it has been unchanged for long enough."""
        return self.settled_s < math.inf


@dataclass(frozen=True, slots=True, eq=False)
class ThingMoment:
    """Data in which both kinds of components are detected.

    Attributes:
        time_s: of the frame [s].
        geometry: of the camera.
        colour: (H, W, 3) or (H, W, 1) image of the same pixels; None without one.
    """

    time_s: float
    geometry: Geometry
    colour: Colours | None


class ThingPieces:
    """Objects of one kind, tracked between frames by common pixels.

    Args:
        config: settings.
        shape: of the image.
    """

    def __init__(self, config: ThingsConfig, shape: tuple[int, int]) -> None:
        self._config = config
        self.owner: Labels = np.zeros(shape, np.int32)
        self.things: dict[int, Thing] = {}
        self._changed: Metres = np.full(shape, NEVER, np.float32)

    def update(
        self, mask: Bools, depth_m: Metres, span: PixelSpan, moment: ThingMoment, next_id: Iterator[int]
    ) -> tuple[list[Thing], list[Thing]]:
        """Process a mask (H, W), depths [m] and times; return the settled and the disappeared objects."""
        config = self._config
        self.owner[~mask | (span.last_s > self._changed)] = 0
        self._changed = span.last_s.copy()
        if not mask.any():
            return [], self._left(set(), mask, depth_m, moment)
        labels, count = pieces_of(mask, depth_m, config.gap_m, span)
        inner = cv2.erode(mask.astype(np.uint8), _AROUND) > 0
        cores = np.bincount(labels[inner], minlength=count + 1)
        parts: dict[int, list[Pixels]] = {}
        for label, pixels in sorted(pixels_by_label(labels, count), key=lambda one: -len(one[1])):
            number = self._owner_of(pixels, span)
            if number is None:
                number = self._shown_again(pixels, depth_m)
            if number is None and len(pixels) >= _FEWEST_PX:
                number = self._beside(pixels, depth_m, span, moment, parts)
            if number is None and self._is_big(pixels, depth_m, cores[label], moment):
                number = next(next_id)
            if number is not None:
                parts.setdefault(number, []).append(pixels)
        return self._followed(parts, mask, depth_m, span, moment)

    def _followed(
        self,
        parts: Mapping[int, Sequence[Pixels]],
        mask: Bools,
        depth_m: Metres,
        span: PixelSpan,
        moment: ThingMoment,
    ) -> tuple[list[Thing], list[Thing]]:
        settled = []
        for number, pieces in parts.items():
            pixels = np.concatenate(pieces)
            self.owner.ravel()[pixels] = number
            known = self.things.get(number)
            self.things[number] = thing = self._measured(number, pixels, depth_m, span, moment, known)
            if thing.is_settled and not (known is not None and known.is_settled):
                settled.append(thing)
        return settled, self._left(set(parts), mask, depth_m, moment)

    def rename(self, old: int, new: int) -> None:
        """Change the id to that of the object that it turned out to be."""
        self.owner[self.owner == old] = new
        self.things[new] = replace(self.things.pop(old), id=new)

    def unseen(self, time_s: float) -> set[int]:
        """Return the ids of objects that have been occluded since a while before a time [s]."""
        return {k for k, one in self.things.items() if time_s - one.seen_s > self._config.unseen_s}

    def newest(self) -> Thing | None:
        """Return the newest object that has not settled, or None."""
        open_ones = [one for one in self.things.values() if not one.is_settled]
        return max(open_ones, key=lambda one: one.id, default=None)

    def _owner_of(self, pixels: Pixels, span: PixelSpan) -> int | None:
        """Return the object that a component was part of, before it settled."""
        owner = self.owner.ravel()[pixels]
        owners = np.bincount(owner)
        if len(owners) < 2:
            return None
        best = int(owners[1:].argmax()) + 1
        thing = self.things.get(best)
        if thing is None or thing.is_gone:
            return None
        own = np.count_nonzero((owner == best) & (span.first_s.ravel()[pixels] <= thing.settled_s))
        most = thing.settled_px if thing.is_settled else thing.most
        return best if own >= _OWN * min(len(pixels), most) else None

    def _shown_again(self, pixels: Pixels, depth_m: Metres) -> int | None:
        """Return the object that was occluded by something else until now."""
        depth = float(np.median(depth_m.ravel()[pixels]))
        for number, thing in self.things.items():
            if thing.is_gone or not thing.is_settled or abs(thing.depth_m - depth) > self._config.gap_m:
                continue
            if np.isin(pixels, thing.where).mean() > _COVERED:
                return number
        return None

    def _beside(
        self,
        pixels: Pixels,
        depth_m: Metres,
        span: PixelSpan,
        moment: ThingMoment,
        parts: Mapping[int, Sequence[Pixels]],
    ) -> int | None:
        """Return the object next to which a component appeared at the same time, as another part of it."""
        points = moment.geometry.points(pixels, depth_m)
        first, last = (float(np.median(times.ravel()[pixels])) for times in (span.first_s, span.last_s))
        for number in {*self.things, *parts}:
            if number in parts:
                others = np.concatenate(parts[number])
                place = np.median(moment.geometry.points(others, depth_m)[:, :2], axis=0)
                spans = [float(np.median(times.ravel()[others])) for times in (span.first_s, span.last_s)]
            else:
                thing = self.things[number]
                if thing.is_gone:
                    continue
                place, spans = np.array(thing.place_m[:2]), list(thing.span_s)
            is_together = max(first, spans[0]) <= min(last, spans[1]) + self._config.beside_s
            if is_together and np.hypot(*(np.median(points[:, :2], axis=0) - place)) < self._config.beside_m:
                return number
        return None

    def _is_big(self, pixels: Pixels, depth_m: Metres, core: int, moment: ThingMoment) -> bool:
        config, count = self._config, len(pixels)
        if count < config.least_px or core < _COMPACT * count:
            return False
        return float((depth_m.ravel()[pixels] ** 2).sum()) / moment.geometry.focal_px**2 >= config.least_m2

    def _measured(
        self,
        number: int,
        pixels: Pixels,
        depth_m: Metres,
        span: PixelSpan,
        moment: ThingMoment,
        known: Thing | None,
    ) -> Thing:
        config, time_s, count = self._config, moment.time_s, len(pixels)
        has_changed = known is None or abs(count - known.steady_px) > config.growth * known.steady_px
        steady_s = time_s if has_changed or known is None else known.steady_s
        first, last = (
            float(np.median(span.first_s.ravel()[pixels])),
            float(np.median(span.last_s.ravel()[pixels])),
        )
        if known is not None and known.is_settled and (count <= known.most or first > known.settled_s):
            return replace(known, pixels=count, seen_s=float(np.median(span.seen_s.ravel()[pixels])))
        points = moment.geometry.points(pixels, depth_m)
        low, high = np.quantile(points[:, 2], [0.02, 0.98]).tolist()
        rows, columns = np.divmod(pixels, depth_m.shape[1])
        left, top = int(columns.min()), int(rows.min())
        x, y, z = np.median(points, axis=0).tolist()
        was_settled = known is not None and known.is_settled
        settles = not was_settled and time_s - steady_s >= config.settled_s
        return Thing(
            id=number,
            box=(float(left), float(top), float(columns.max() - left + 1), float(rows.max() - top + 1)),
            pixels=count,
            most=max(count, known.most if known is not None else 0),
            where=pixels,
            depth_m=float(np.median(depth_m.ravel()[pixels])),
            place_m=(x, y, z),
            size_m2=float((depth_m.ravel()[pixels] ** 2).sum()) / moment.geometry.focal_px**2,
            height_m=high - low,
            top_m=high,
            colour=None
            if moment.colour is None
            else moment.colour.reshape(-1, moment.colour.shape[2])[pixels].mean(axis=0),
            span_s=(min(first, last), last),
            seen_s=float(np.median(span.seen_s.ravel()[pixels])),
            steady_s=steady_s,
            steady_px=count if has_changed or known is None else known.steady_px,
            settled_s=time_s if settles else math.inf if known is None else known.settled_s,
            settled_px=count if settles or known is None else known.settled_px,
        )

    def _left(self, present: set[int], mask: Bools, depth_m: Metres, moment: ThingMoment) -> list[Thing]:
        """Return the objects that have disappeared; forget those that never settled."""
        left = []
        for number, thing in list(self.things.items()):
            is_less = number not in present or thing.pixels < self._config.left * thing.most
            if thing.is_gone or not is_less:
                continue
            before = depth_m.ravel()[thing.where] < thing.depth_m + self._config.gap_m
            if thing.is_settled and (mask.ravel()[thing.where] & before).mean() > _COVERED:
                continue  # occluded by something else
            if not thing.is_settled:
                del self.things[number]
                continue
            self.things[number] = replace(thing, is_gone=True, pixels=0)
            left.append(replace(thing, span_s=(thing.seen_s, moment.time_s)))
            self.owner[self.owner == number] = 0
        return left


def standing(layers: Layers, config: ThingsConfig) -> tuple[Bools, Metres, PixelSpan]:
    """Return the objects in front of the background: mask, depth [m], and time of change."""
    front, since = layers.front_m, layers.front_since_s
    mask = layers.is_covered & (layers.background_m - front > config.off_m)
    return (
        mask,
        front,
        PixelSpan(np.minimum(layers.back_seen_s, since), since, layers.front_seen_s, config.slack_s),
    )


def opened(layers: Layers, config: ThingsConfig) -> tuple[Bools, Metres, PixelSpan]:
    """Return the former background in front of a farther one: mask, depth [m], and time of change."""
    past, gone = layers.past_m, layers.past_gone_s
    mask = (past > 0.0) & (layers.background_m - past > config.off_m)
    first = np.minimum(layers.past_seen_s, gone)
    return mask, past, PixelSpan(first, gone, layers.past_seen_s, config.slack_s)


def pieces_like(
    thing: Thing, mask: Bools, depth_m: Metres, geometry: Geometry, config: ThingsConfig
) -> Iterator[tuple[tuple[float, float], Pixels]]:
    """Return the compact components of a mask (H, W): their positions on the floor, and pixels."""
    labels, count = pieces_of(mask, depth_m, config.gap_m)
    cores = np.bincount(labels[cv2.erode(mask.astype(np.uint8), _AROUND) > 0], minlength=count + 1)
    for label, pixels in pixels_by_label(labels, count):
        size = float((depth_m.ravel()[pixels] ** 2).sum()) / geometry.focal_px**2 / thing.size_m2
        is_like = 1.0 / config.size_ratio < size < config.size_ratio
        if is_like and len(pixels) >= config.least_px // 2 and cores[label] >= _COMPACT * len(pixels):
            x, y, _ = np.median(geometry.points(pixels, depth_m), axis=0).tolist()
            yield (x, y), pixels
