"""Movable things: pieces of what stands before the background, and of what stood there until it was seen through."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.frame import Floats
from peopleboy.tracker.scene_model.geometry import Geometry
from peopleboy.tracker.scene_model.layers import NEVER, Layers, inverted
from peopleboy.tracker.scene_model.pieces import Bools, Span, pieces_of
from peopleboy.tracker.scene_model.scene import Labels, Metres, Place
from peopleboy.tracker.scene_model.scene_config import ThingsConfig
from peopleboy.tracker.track import Box

Colours = NDArray[np.uint8]

_AROUND = np.ones((3, 3), np.uint8)
_COMPACT: Final = 0.2  # share of a thing's pixels that are not at its edge; edges of walls are only that
_OWN: Final = 0.5  # share of a piece that a thing must have had to keep it


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Thing:
    """A piece of the image that changed at one time.

    Attributes:
        id: of the object that it is.
        box: left, top, width, height [px].
        pixels: how many it has now.
        most: the most it had.
        place_m: its middle in the robot's frame [m].
        size_m2: its area before the camera [m^2].
        height_m: from its lowest to its highest point [m].
        top_m: its highest point above the floor [m].
        colour: (3,) mean RGB; None without colours.
        span_s: between which times it changed [s].
        steady_s, steady_px: since when it has not grown, and its pixels then.
        is_settled: whether it stayed as it is for long enough.
        is_gone: whether it left.
    """

    id: int
    box: Box
    pixels: int
    most: int
    place_m: Place
    size_m2: float
    height_m: float
    top_m: float
    colour: Floats | None
    span_s: tuple[float, float]
    steady_s: float
    steady_px: int
    is_settled: bool = False
    is_gone: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """What both kinds of pieces are found in.

    Attributes:
        time_s: of the frame [s].
        geometry: of the camera.
        colour: (H, W, 3) image of the same pixels; None without one.
    """

    time_s: float
    geometry: Geometry
    colour: Colours | None


class Pieces:
    """Things of one kind, followed from frame to frame by the pixels that they share.

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
        self, mask: Bools, depth_m: Metres, span: Span, moment: Moment, next_id: Iterator[int]
    ) -> tuple[list[Thing], list[Thing]]:
        """Take in a mask (H, W), depths [m] and times; give the things that settled and those that left."""
        config = self._config
        self.owner[~mask | (span.last_s > self._changed)] = 0
        self._changed = span.last_s.copy()
        if not mask.any():
            return [], self._left(set(), moment)
        labels, count = pieces_of(mask, depth_m, config.gap_m, span)
        inner = cv2.erode(mask.astype(np.uint8), _AROUND) > 0
        sizes = np.bincount(labels.ravel(), minlength=count + 1)
        cores = np.bincount(labels[inner], minlength=count + 1)
        likely = np.flatnonzero((sizes >= config.least_px // 2) & (cores >= _COMPACT * sizes))
        settled, present = [], set()
        for label in likely[likely > 0].tolist():
            pixels = np.flatnonzero(labels.ravel() == label)
            thing = self._of_piece(pixels, depth_m, span, moment, next_id)
            if thing is None:
                continue
            present.add(thing.id)
            if thing.is_settled and not self._was_settled(thing.id):
                settled.append(thing)
            self.things[thing.id] = thing
        return settled, self._left(present, moment)

    def rename(self, old: int, new: int) -> None:
        """Call a thing by the id of the object that it turned out to be."""
        self.owner[self.owner == old] = new
        self.things[new] = replace(self.things.pop(old), id=new)

    def _was_settled(self, number: int) -> bool:
        return number in self.things and self.things[number].is_settled

    def _of_piece(
        self, pixels: NDArray[np.intp], depth_m: Metres, span: Span, moment: Moment, next_id: Iterator[int]
    ) -> Thing | None:
        config = self._config
        owners = np.bincount(self.owner.ravel()[pixels])
        best = int(owners[1:].argmax()) + 1 if len(owners) > 1 else 0
        known = self.things.get(best) if best and owners[best] > _OWN * self._most(best) * config.left else None
        if known is None and len(pixels) < config.least_px:
            return None
        depth = depth_m.ravel()[pixels]
        size = float((depth**2).sum()) / moment.geometry.focal_px**2
        if known is None and size < config.least_m2:
            return None
        number = next(next_id) if known is None else known.id
        self.owner.ravel()[pixels] = number
        return self._measured(number, pixels, depth_m, size, span, moment, known)

    def _most(self, number: int) -> int:
        return self.things[number].most if number in self.things else 0

    def _measured(
        self,
        number: int,
        pixels: NDArray[np.intp],
        depth_m: Metres,
        size_m2: float,
        span: Span,
        moment: Moment,
        known: Thing | None,
    ) -> Thing:
        config, time_s, count = self._config, moment.time_s, len(pixels)
        has_changed = known is None or abs(count - known.steady_px) > config.growth * known.steady_px
        steady_s = time_s if has_changed or known is None else known.steady_s
        if known is not None and known.is_settled and count <= known.most:
            return replace(known, pixels=count)
        points = moment.geometry.points(pixels, depth_m)
        low, high = np.quantile(points[:, 2], [0.02, 0.98]).tolist()
        rows, columns = np.divmod(pixels, depth_m.shape[1])
        left, top = int(columns.min()), int(rows.min())
        x, y, z = np.median(points, axis=0).tolist()
        first, last = float(np.median(span.first_s.ravel()[pixels])), float(np.median(span.last_s.ravel()[pixels]))
        return Thing(
            id=number,
            box=(float(left), float(top), float(columns.max() - left + 1), float(rows.max() - top + 1)),
            pixels=count,
            most=max(count, known.most if known is not None else 0),
            place_m=(x, y, z),
            size_m2=size_m2,
            height_m=high - low,
            top_m=high,
            colour=None if moment.colour is None else moment.colour.reshape(-1, 3)[pixels].mean(axis=0),
            span_s=(min(first, last), last),
            steady_s=steady_s,
            steady_px=count if has_changed or known is None else known.steady_px,
            is_settled=(known is not None and known.is_settled) or time_s - steady_s >= config.settled_s,
        )

    def _left(self, present: set[int], moment: Moment) -> list[Thing]:
        """Find the things of which too little is left; forget those that never settled."""
        left = []
        for number, thing in list(self.things.items()):
            is_less = number not in present or thing.pixels < self._config.left * thing.most
            if thing.is_gone or not is_less:
                continue
            if not thing.is_settled:
                del self.things[number]
                continue
            self.things[number] = replace(thing, is_gone=True, pixels=0)
            left.append(replace(thing, span_s=(thing.span_s[1], moment.time_s)))
            self.owner[self.owner == number] = 0
        return left


def standing(layers: Layers, config: ThingsConfig) -> tuple[Bools, Metres, Span]:
    """Find what stands before the background: where, at which depth [m], and since when."""
    front, back = inverted(layers.front), layers.background_m
    mask = (layers.front_count > 0.0) & (back - front > config.off_m)
    first = np.minimum(layers.back_seen_s, layers.front_since_s)
    return mask, front, Span(first, layers.front_since_s, config.slack_s)


def opened(layers: Layers, config: ThingsConfig) -> tuple[Bools, Metres, Span]:
    """Find what stood where something farther is seen since: where, at which depth [m], and until when."""
    past = inverted(layers.past)
    mask = (past > 0.0) & (layers.background_m - past > config.off_m)
    return mask, past, Span(np.minimum(layers.past_seen_s, layers.past_gone_s), layers.past_gone_s, config.slack_s)
