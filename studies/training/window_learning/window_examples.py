"""Examples of windows with people and without, from scenes with the truth."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.calibrations import calibrations_of
from peopleboy.scenarios.run_folder.atomic_output import atomic
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.sim.truth.truth import PersonTruth, Truth
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR
from peopleboy.tracker.rgbd.depth_view import Depth, DepthView
from peopleboy.tracker.rgbd.pre_detection import HumanSize, Layout, PreDetection, PreDetector
from peopleboy.tracker.rgbd.u_depth import UDepthConfig
from peopleboy.tracker.rgbd.verification.window_model import feature_length
from peopleboy.tracker.rgbd.verification.windows import Image, Range, cut, cut_depth, hog, range_of, window_of
from peopleboy.tracker.track import Box

APART_S: Final = 0.4
"""Between two images that are learned from."""

_SIZE: Final = HumanSize(least=0.005)  # what is less like a human is no good example of what is none
_NEAR_M: Final = 0.5
_APART_M: Final = 0.9
_LEAST_VISIBLE: Final = 0.6
_MOST_SHOWN: Final = 0.15  # share of a window that may show people if it is to be a good example of none
_JITTERS: Final = 3
_SHIFT: Final = 0.04  # deviation of a window's place, in its sizes
_SCALE: Final = 0.06  # deviation of the logarithm of its size
_FLATS: Final = 2  # windows of an image that are placed anywhere


@dataclass(frozen=True, slots=True, eq=False)
class WindowExamples:
    """Windows by range.

    Attributes:
        features: (N, 2 F) float16 histograms of oriented gradients, of colour and then of depth.
        is_person: (N,) whether a person is there.
    """

    features: Mapping[Range, NDArray[np.float16]]
    is_person: Mapping[Range, NDArray[np.bool_]]

    @classmethod
    def joined(cls, parts: Sequence[WindowExamples]) -> WindowExamples:
        """Take examples together."""
        return cls(
            {kind: np.concatenate([one.features[kind] for one in parts]) for kind in Range},
            {kind: np.concatenate([one.is_person[kind] for one in parts]) for kind in Range},
        )

    def save(self, path: Path) -> None:
        """Write them, whole or not at all."""
        arrays: dict[str, Any] = {f"{kind}_features": self.features[kind] for kind in Range}
        arrays |= {f"{kind}_is_person": self.is_person[kind].astype(np.float16) for kind in Range}
        with atomic(path) as part, part.open("wb") as file:
            np.savez(file, **arrays)

    @classmethod
    def load(cls, path: Path) -> WindowExamples:
        """Read them."""
        with np.load(path, allow_pickle=False) as arrays:
            return cls(
                {kind: arrays[f"{kind}_features"] for kind in Range},
                {kind: arrays[f"{kind}_is_person"] > 0.5 for kind in Range},
            )


@dataclass(frozen=True, slots=True, eq=False)
class _Example:
    """A window of an image, and whether a person is in it."""

    image: Image
    depth: Depth
    z_m: float
    window: Box
    kind: Range
    is_person: bool


def collect_windows(scenario: Scenario, seed: int, *, has_jitter: bool) -> WindowExamples:
    """Play a scenario, and keep the windows of what has about the size of a human.

    Raises:
        BadInput: the robot needs eyes to drive.
    """
    scenario, rng = scenario.mounting((DEPTH,)), np.random.default_rng((seed, 2012))
    calibration = calibrations_of(scenario.world(seed).robot.cameras)[DEPTH]
    view, detector = DepthView.of(calibration, DEPTH), PreDetector(_SIZE, UDepthConfig())
    rows: dict[Range, list[NDArray[np.float16]]] = {kind: [] for kind in Range}
    labels: dict[Range, list[bool]] = {kind: [] for kind in Range}
    next_s = 0.0
    for world, observation in blind_drive(scenario, seed):
        if DEPTH not in observation.images or observation.time_s < next_s:
            continue
        next_s = observation.time_s + APART_S
        depth, image = observation.images[DEPTH], observation.images[DEPTH_COLOUR]
        layout = detector(depth, view)
        for example in _examples(image, depth, layout, view, world.truth(DEPTH), rng):
            for window in _looks(example, rng, has_jitter=has_jitter):
                rows[example.kind].append(window)
                labels[example.kind].append(example.is_person)
    return WindowExamples(
        {kind: np.array(rows[kind], np.float16).reshape(-1, 2 * feature_length(kind)) for kind in Range},
        {kind: np.array(labels[kind], np.bool_) for kind in Range},
    )


def _examples(
    image: Image,
    depth: Depth,
    layout: Layout,
    view: DepthView,
    truth: Truth,
    rng: np.random.Generator,
) -> Iterator[_Example]:
    for found in (*layout.detections, *_anywhere(layout, view, image.shape[:2], rng)):
        kind = range_of(found.z_m, layout.floor, view, image.shape[0])
        is_person = _is_person(found, truth, view)
        if is_person is not None:
            yield _Example(
                image, depth, found.z_m, window_of(found, kind, layout.floor, view), kind, is_person
            )


def _is_person(found: PreDetection, truth: Truth, view: DepthView) -> bool | None:
    """Tell whether something is a person; None for what is hardly one."""
    at = view.on_floor(np.array([found.x_m]), np.array([found.z_m]))[0]
    answer: bool | None = False
    for person in truth.people:
        away = math.dist(truth.robot.to_local(person.position_m), at)
        inside = person.inside_fraction
        if away < _NEAR_M and inside > 0.0 and person.visible_fraction / inside > _LEAST_VISIBLE:
            return True if _has_head(person) else None
        if away < _APART_M and person.visible_px:
            answer = None
    return answer if answer is None or not _shows_somebody(found, truth) else None


def _has_head(person: PersonTruth) -> bool:
    """Tell whether the head is in the image; of who is so near that it is not, no window shows enough."""
    return person.whole_box is not None and person.whole_box[1] > -0.02 * person.whole_box[3]


def _shows_somebody(found: PreDetection, truth: Truth) -> bool:
    left, top, width, height = (max(round(x), 0) for x in found.box)
    inside = truth.instance[top : top + height, left : left + width]
    return inside.size > 0 and float((inside > 0).mean()) > _MOST_SHOWN


def _anywhere(
    layout: Layout, view: DepthView, shape: tuple[int, int], rng: np.random.Generator
) -> Iterator[PreDetection]:
    """Place bodies anywhere, mostly on plain walls and floors: a near window of these must not pass."""
    size = HumanSize()
    for _ in range(_FLATS):
        z_m = float(rng.uniform(1.2, 8.0))
        wide = size.width_m * view.focal_px / z_m
        left = float(rng.uniform(0.0, shape[1] - wide))
        top = float(layout.floor.raised(rng.uniform(1.5, 1.9)).rows(np.array([z_m]), view)[0])
        tall = min(size.height_m * view.focal_px / z_m, shape[0] - max(top, 0.0))
        x_m = (left + wide / 2.0 - view.centre_u) * z_m / view.focal_px
        yield PreDetection(
            box=(left, max(top, 0.0), wide, max(tall, 1.0)), x_m=x_m, z_m=z_m,
            width_m=size.width_m, height_m=size.height_m, depth_m=size.depth_m, probability=0.0,
        )  # fmt: skip


def _looks(example: _Example, rng: np.random.Generator, *, has_jitter: bool) -> Iterator[NDArray[np.float16]]:
    """Give the histograms of a window; to learn from, of people also a little off, and of all mirrored."""
    windows = [example.window]
    if has_jitter and example.is_person:
        windows += [_jittered(example.window, rng) for _ in range(_JITTERS)]
    for window in windows:
        patches = (
            cut(example.image, window, example.kind),
            cut_depth(example.depth, example.z_m, window, example.kind),
        )
        yield _described(patches, example.kind)
        if has_jitter:
            yield _described([np.ascontiguousarray(patch[:, ::-1]) for patch in patches], example.kind)


def _described(patches: Sequence[Image], kind: Range) -> NDArray[np.float16]:
    return np.concatenate([hog(patch, kind) for patch in patches]).astype(np.float16)


def _jittered(window: Box, rng: np.random.Generator) -> Box:
    left, top, width, height = window
    grown = math.exp(rng.normal(0.0, _SCALE))
    left += width * (rng.normal(0.0, _SHIFT) + (1.0 - grown) / 2.0)
    top += height * (rng.normal(0.0, _SHIFT) + (1.0 - grown) / 2.0)
    return left, top, grown * width, grown * height
