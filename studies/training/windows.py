"""Train linear support vector machines that classify windows of colour and depth images as people."""

import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario, parse_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.sim.cameras.camera_config import calibrations_of
from peopleboy.sim.truth.truth import PersonTruth, Truth
from peopleboy.studies.training.random_scenes import FIRST_SEED, random_scene
from peopleboy.studies.training.samples import Arrays, SampleTask, Split, Tasks, load_samples, sample_folder
from peopleboy.studies.training.specification import Specification, missing_package
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR
from peopleboy.tracker.sensors.depth.depth_view import DepthView, Image
from peopleboy.tracker.sensors.depth.human_windows import (
    Features,
    WindowRange,
    cut,
    cut_depth,
    hog,
    range_of,
    window_of,
)
from peopleboy.tracker.sensors.depth.pre_detection import HumanSize, Layout, PreDetection, PreDetector
from peopleboy.tracker.sensors.depth.u_depth import UDepthConfig
from peopleboy.tracker.sensors.depth.window_model import WindowModel, feature_length, file_name
from peopleboy.tracker.track import Box

COST: Final = {WindowRange.FAR: 0.01, WindowRange.NEAR: 0.01}
FALSE_ALARMS: Final = 0.01
"""False positive rate at which recall is measured."""
VALIDATION: Final[Mapping[str, int]] = {
    "": 30,
    "crossing_2_moving": 2,
    "crowd_8_moving": 1,
    "fast_turn": 2,
    "hall_visits": 1,
}
"""Sequences of the validation split: random scenes, and scenarios in other places."""
APART_S: Final = 0.4
"""Time between two sampled images."""

_SIZE: Final = HumanSize(least=0.005)  # less human-like candidates are too easy as negatives
_NEAR_M: Final = 0.5
_APART_M: Final = 0.9
_LEAST_VISIBLE: Final = 0.6
_MOST_SHOWN: Final = 0.15  # largest share of a negative window that shows people
_JITTERS: Final = 3
_SHIFT: Final = 0.04  # standard deviation of a window's position, in window sizes
_SCALE: Final = 0.06  # standard deviation of the logarithm of its size
_FLATS: Final = 2  # randomly placed windows per image


@dataclass(frozen=True, slots=True, eq=False)
class WindowSamples(Arrays):
    """Windows by range.

    Attributes:
        near_features, far_features: (N, 2 F) float16 histograms of oriented gradients, of colour, then depth.
        near_is_person, far_is_person: (N,) whether a person is there.
    """

    near_features: NDArray[np.float16]
    far_features: NDArray[np.float16]
    near_is_person: NDArray[np.bool_]
    far_is_person: NDArray[np.bool_]

    def features(self, kind: WindowRange) -> NDArray[np.float16]:
        """Return the features of a range."""
        return self.near_features if kind is WindowRange.NEAR else self.far_features

    def is_person(self, kind: WindowRange) -> NDArray[np.bool_]:
        """Return the labels of a range."""
        return self.near_is_person if kind is WindowRange.NEAR else self.far_is_person


def collect_windows(scenario: str, seed: int, has_jitter: bool) -> WindowSamples:
    """Run a scenario, and collect windows of candidates that have about the size of a human.

    Args:
        scenario: name in the library; empty for a random scene.
        seed: of scene and run.
        has_jitter: whether to augment: add displaced and mirrored windows.

    Raises:
        BadInput: the robot needs images to drive.
    """
    loaded, rng = _scenario(scenario, seed).mounting((DEPTH,)), np.random.default_rng((seed, 2012))
    calibration = calibrations_of(loaded.world(seed).robot.cameras)[DEPTH]
    view, detector = DepthView.of(calibration, DEPTH), PreDetector(_SIZE, UDepthConfig())
    rows: dict[WindowRange, list[NDArray[np.float16]]] = {kind: [] for kind in WindowRange}
    labels: dict[WindowRange, list[bool]] = {kind: [] for kind in WindowRange}
    next_s = 0.0
    for world, observation in blind_drive(loaded, seed):
        if DEPTH not in observation.images or observation.time_s < next_s:
            continue
        next_s = observation.time_s + APART_S
        depth, image = observation.images[DEPTH], observation.images[DEPTH_COLOUR]
        layout, truth = detector(depth, view), world.truth(DEPTH)
        for found in (*layout.detections, *_anywhere(layout, view, image.shape[:2], rng)):
            is_person = _is_person(found, truth, view)
            if is_person is None:
                continue
            kind = range_of(found.z_m, layout.floor, view, image.shape[0])
            windows = [window_of(found.box, found.z_m, kind, layout.floor, view)]
            if has_jitter and is_person:
                windows += [_jittered(windows[0], rng) for _ in range(_JITTERS)]
            for window in windows:
                patches = cut(image, window, kind), cut_depth(depth, found.z_m, window, kind)
                described = _describe(patches, kind, is_mirrored=has_jitter)
                rows[kind] += described
                labels[kind] += [is_person] * len(described)
    features = {
        kind: np.array(rows[kind], np.float16).reshape(-1, 2 * feature_length(kind)) for kind in WindowRange
    }
    return WindowSamples(
        features[WindowRange.NEAR],
        features[WindowRange.FAR],
        np.array(labels[WindowRange.NEAR], np.bool_),
        np.array(labels[WindowRange.FAR], np.bool_),
    )


def _scenario(name: str, seed: int) -> Scenario:
    if name:
        return load_scenario(name)
    data = random_scene(seed, DEPTH)
    return parse_scenario(data, source=data["name"], folder=Path())


def _is_person(found: PreDetection, truth: Truth, view: DepthView) -> bool | None:
    """Return whether a candidate is a person; None if it is ambiguous."""
    at = view.on_floor(np.array([found.x_m]), np.array([found.z_m]))[0]
    answer: bool | None = False
    for person in truth.people:
        away = math.dist(truth.robot.to_local(person.position_m), at)
        inside = person.inside_fraction
        if away < _NEAR_M and inside > 0.0 and person.visible_fraction / inside > _LEAST_VISIBLE:
            return True if _has_head(person) else None
        if away < _APART_M and person.visible_px:
            answer = None
    return answer if answer is None or not _shows_people(found, truth) else None


def _has_head(person: PersonTruth) -> bool:
    """Return whether the head is in the image; without it no window shows enough of the person."""
    return person.whole_box is not None and person.whole_box[1] > -0.02 * person.whole_box[3]


def _shows_people(found: PreDetection, truth: Truth) -> bool:
    left, top, width, height = (max(round(x), 0) for x in found.box)
    inside = truth.instance[top : top + height, left : left + width]
    return inside.size > 0 and float((inside > 0).mean()) > _MOST_SHOWN


def _anywhere(
    layout: Layout, view: DepthView, shape: tuple[int, int], rng: np.random.Generator
) -> Iterator[PreDetection]:
    """Place windows at random, mostly on plain walls and floors, which the near classifier must reject."""
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


def _describe(patches: Sequence[Image], kind: WindowRange, *, is_mirrored: bool) -> list[NDArray[np.float16]]:
    """Return the histograms of a window's patches, and of their mirror images."""
    sides = [patches, [np.ascontiguousarray(patch[:, ::-1]) for patch in patches]]
    return [
        np.concatenate([hog(patch, kind) for patch in side]).astype(np.float16)
        for side in sides[: 1 + is_mirrored]
    ]


def _jittered(window: Box, rng: np.random.Generator) -> Box:
    left, top, width, height = window
    grown = math.exp(rng.normal(0.0, _SCALE))
    left += width * (rng.normal(0.0, _SHIFT) + (1.0 - grown) / 2.0)
    top += height * (rng.normal(0.0, _SHIFT) + (1.0 - grown) / 2.0)
    return left, top, grown * width, grown * height


@dataclass(frozen=True, slots=True, kw_only=True)
class WindowsTraining(Specification[Split[WindowSamples]]):
    """The tracker rgbd uses these classifiers.

    There are classifiers for near and far windows, each with and without depth. The training data are random
    scenes.
    """

    sequences: Annotated[
        int, Field(ge=1, le=100_000, alias="seeds", description="Number of random scenes to train on.")
    ] = 300

    def tasks(self, out: Path) -> Tasks:
        """Run scenes, and collect windows."""
        folder = sample_folder(out, Path(__file__))

        def task(scenario: str, seed: int, *, has_jitter: bool) -> SampleTask:
            path = folder / f"{scenario or 'scene'}_{seed}.npz"
            return SampleTask(path, collect_windows, (scenario, seed, has_jitter))

        return Split(
            [task("", FIRST_SEED + k, has_jitter=True) for k in range(self.sequences)],
            [task(name, k, has_jitter=False) for name, count in VALIDATION.items() for k in range(count)],
        )

    def load(self, tasks: Tasks) -> Split[WindowSamples]:
        """Read the samples."""
        return Split(*(load_samples(WindowSamples, part) for part in tasks))

    def fit(self, data: Split[WindowSamples]) -> Mapping[str, WindowModel]:
        """Train both pairs of classifiers."""
        about = {"trained on": f"{self.sequences} random scenes, seeds from {FIRST_SEED}"}
        return {
            file_name(sees_depth=sees): WindowModel(
                {kind: fit_machine(data.training, kind, sees_depth=sees) for kind in WindowRange}, about
            )
            for sees in (False, True)
        }

    def evaluate(self, model: WindowModel, data: Split[WindowSamples]) -> Mapping[str, str]:
        """Measure recall and false positive rate by range."""
        return {
            f"{kind}, on other scenes": evaluate_machine(model, data.validation, kind) for kind in WindowRange
        }


def fit_machine(samples: WindowSamples, kind: WindowRange, *, sees_depth: bool) -> Features:
    """Train a linear support vector machine, and return its weights with the bias last.

    Raises:
        BadInput: scikit-learn is missing, or this range has no positives or no negatives.
    """
    try:
        from sklearn.svm import LinearSVC  # imported late: evaluation does not need it
    except ImportError:
        raise missing_package("windows", "scikit-learn") from None
    is_person = samples.is_person(kind)
    if is_person.all() or not is_person.any():
        raise BadInput(f"{kind} windows: {len(is_person)} with {is_person.sum()} people; use more sequences")
    count = (1 + sees_depth) * feature_length(kind)
    machine = LinearSVC(C=COST[kind], class_weight="balanced", random_state=0, max_iter=4000)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about convergence, which need not be exact
        machine.fit(samples.features(kind)[:, :count].astype(np.float32), is_person)
    return np.concatenate([machine.coef_[0], machine.intercept_]).astype(np.float32)


def recall_at(scores: NDArray[np.float64], is_person: NDArray[np.bool_], false_alarms: float) -> float:
    """Return the recall at a given false positive rate."""
    limit = np.quantile(scores[~is_person], 1.0 - false_alarms)
    return float(np.mean(scores[is_person] > limit))


def scores_of(model: WindowModel, samples: WindowSamples, kind: WindowRange) -> NDArray[np.float64]:
    """Return the scores (N,) of the windows of a range."""
    weights = model.weights[kind]
    features = samples.features(kind)[:, : len(weights) - 1].astype(np.float64)
    return np.asarray(features @ weights[:-1] + weights[-1])


def evaluate_machine(model: WindowModel, samples: WindowSamples, kind: WindowRange) -> str:
    """Return a text with recall and false positive rate of the classifier of a range."""
    scores, is_person = scores_of(model, samples, kind), samples.is_person(kind)
    if is_person.all() or not is_person.any():
        return "no samples"
    return (
        f"{is_person.sum()} people, {(~is_person).sum()} others; recall "
        f"{recall_at(scores, is_person, FALSE_ALARMS):.3f} at a false positive rate of 1 %; "
        f"at threshold 0: recall {np.mean(scores[is_person] > 0):.3f}, "
        f"false positive rate {np.mean(scores[~is_person] > 0):.3f}"
    )
