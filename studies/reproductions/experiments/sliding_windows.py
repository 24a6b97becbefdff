"""Detect people in windows, sliding over images or placed by size in depth; and count parameters.

Source: thesis on situation awareness, sections 4.4.2, 4.7.4 and 4.7.8.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import partial
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.random_streams import stream
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.running.engine.store import Result
from peopleboy.studies.reproductions.experiment import Line, Row, Samples, as_columns, ratio
from peopleboy.studies.reproductions.experiments.drive_scores import FloorPerson
from peopleboy.studies.reproductions.experiments.drive_tracking import (
    COLOUR_ONLY,
    DEFAULT,
    PARTICLES,
    SETS,
    make_choice,
    play_drive,
)
from peopleboy.studies.reproductions.experiments.playback import Stopwatch
from peopleboy.studies.reproductions.plan import shortened
from peopleboy.studies.reproductions.units import Measurement, Unit
from peopleboy.studies.training.windows import FALSE_ALARMS, VALIDATION, collect_windows, recall_at, scores_of
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, Frame
from peopleboy.tracker.reproductions.rgbd.rgbd_config import FloorFilterConfig, HypothesesConfig
from peopleboy.tracker.sensors.depth.depth_view import DepthView, Image
from peopleboy.tracker.sensors.depth.human_windows import SIZES, WindowRange, range_of, window_of
from peopleboy.tracker.sensors.depth.pre_detection import HumanSize, Layout, PreDetection, PreDetector
from peopleboy.tracker.sensors.depth.u_depth import UDepthConfig
from peopleboy.tracker.sensors.depth.v_disparity import HeightLine
from peopleboy.tracker.sensors.depth.window_model import people_detector, shipped_windows
from peopleboy.tracker.track import Box

Floats = NDArray[np.float64]

BY_SIZE: Final = "pre-detection + verification"
PARTS: Final = ("pre-detection", "verification", "hypotheses and filters")

_OVERLAP: Final = 0.4  # of a window with that of a found person
_DOUBLE: Final = 0.4  # minimum overlap at which the weaker one of two windows is suppressed
_HIDDEN: Final = 0.5  # hidden share above which a person need not be found
_TORSO_M, _FRONT_M = 0.45, 0.1  # width of a body, and distance from its centre to the visible surface


@dataclass(frozen=True, slots=True)
class Slide:
    """Parameters of sliding windows.

    Attributes:
        kind: kind of the windows.
        shift_px: shift between windows.
        scale: factor by which the image shrinks from step to step.
        is_opencv: whether OpenCV's people detector classifies them, or the tracker's own classifier.
    """

    kind: WindowRange
    shift_px: int
    scale: float
    is_opencv: bool = False

    @property
    def name(self) -> str:
        """Shift and scale, as in tables."""
        return f"{self.shift_px} px, scale {self.scale:.2f}"

    @property
    def key(self) -> str:
        """All parameters as text."""
        return f"{self.kind} {self.name}{' by OpenCV' if self.is_opencv else ''}"


FAR_SLIDES: Final = tuple(
    Slide(WindowRange.FAR, shift, scale, is_opencv)
    for shift, scale in ((4, 1.05), (8, 1.05), (8, 1.1), (8, 1.2))
    for is_opencv in (True, False)
)
"""SA table 4.3."""

NEAR_SLIDES: Final = tuple(
    Slide(WindowRange.NEAR, shift, scale) for shift, scale in ((4, 1.1), (8, 1.05), (8, 1.1))
)
"""SA table 4.4."""


OWN, COLOUR, OPENCV = "own machine", "own machine, colour alone", "OpenCV's detector"
NEAR, FAR = str(WindowRange.NEAR), str(WindowRange.FAR)
MODELS: Final = ((FAR, OWN), (FAR, COLOUR), (FAR, OPENCV), (NEAR, OWN), (NEAR, COLOUR))
"""Ranges, and the classifiers of their windows."""
BOTH: Final = f"{NEAR}+{FAR} {BY_SIZE}"
_SLID: Final = (6, 7, 11)  # numbers of the sets whose images are searched

_Window = tuple[WindowRange, Sequence[float]]


def loop_times(using: Measurement) -> Samples:
    """Time a frame with and without pre-detection [ms] (table 4.2)."""
    found = _slid(using)
    rest = found["parts"]["hypotheses and filters"]
    slid, by_size = found["far 8 px, scale 1.10"]["ms"], found[BOTH]["ms"]
    times = {
        "detection by sliding windows": slid,
        "detection by size": by_size,
        "hypotheses and filters": rest,
        "all, sliding windows": slid + rest,
        "all, by size": by_size + rest,
    }
    return {Line(name, OWN): as_columns([{"ms": ms}]) for name, ms in times.items()}


def sliding_windows(using: Measurement, *, window: str) -> Samples:
    """Measure times and rates of near or far windows slid over whole images (tables 4.3 and 4.4)."""
    found = _slid(using)
    rows = {
        Line(one.name, OPENCV if one.is_opencv else OWN): found[one.key]
        for one in (FAR_SLIDES if window == FAR else NEAR_SLIDES)
    }
    rows[Line(BY_SIZE, OWN)] = found[f"{window} {BY_SIZE}"]
    return {line: as_columns([_tallied(tally)]) for line, tally in rows.items()}


def windows_by_size(using: Measurement) -> Samples:
    """Measure times and rate of windows on regions of a person's size (table 4.5)."""
    found = _slid(using)
    parts = {name: {"ms": found["parts"][name]} for name in ("pre-detection", "verification")}
    rows = {**parts, "total": _tallied(found[BOTH])}
    return {Line(name, OWN): as_columns([row]) for name, row in rows.items()}


def parameters(using: Measurement) -> Samples:  # noqa: ARG001
    """Count the parameters that must be chosen, without switches (table 4.7)."""
    counts = {
        "pre-detection": _numbers(HumanSize) + _numbers(UDepthConfig),
        "classification": 2,  # one score per range
        "hypotheses": _numbers(HypothesesConfig),
        "tracking": _numbers(FloorFilterConfig),
    }
    counts["sum"] = sum(counts.values())
    return {Line(name, "default"): as_columns([{"parameters": count}]) for name, count in counts.items()}


def window_models(using: Measurement) -> Samples:
    """Measure recall and false positives of window classifiers in places outside their training sets."""
    runs = [(name, seed) for name, count in VALIDATION.items() if name for seed in range(count)]
    runs = runs[:1] if using.plan.is_quick else runs
    scores = using.results(Unit.of(score_windows, name, seed) for name, seed in runs)
    return {
        Line(f"{kind} windows", model): as_columns([_judged([one[f"{kind} {model}"] for one in scores])])
        for kind, model in MODELS
    }


def _judged(scores: Sequence[Mapping[str, Sequence[float]]]) -> Row:
    people, others = (np.concatenate([one[kind] for one in scores]) for kind in ("people", "others"))
    together = np.concatenate([people, others])
    return {
        "people": len(people),
        "others": len(others),
        "recall at 1 % false": recall_at(together, np.arange(len(together)) < len(people), FALSE_ALARMS),
        "recall at 0": float(np.mean(people > 0.0)),
        "false at 0": float(np.mean(others > 0.0)),
    }


def _slid(using: Measurement) -> Result:
    """Search the same images with all methods; times are exact only if a unit runs alone."""
    plan = using.plan
    names, every = tuple(SETS[n - 1] for n in plan.sets if n in _SLID), 30 if plan.is_quick else 10
    (found,) = using.results([Unit.of(compare_windows, names, plan.drive_s, every, is_timing=True)])
    return found


def _tallied(plain: Mapping[str, Any]) -> Row:
    return {
        "ms": plain["ms"],
        "rate": ratio(plain["found"], plain["people"]),
        "FP": plain["false"],
        "FP per image": plain["false"] / plain["images"],
        "images": plain["images"],
    }


def _numbers(config: type[Any]) -> int:
    return sum(str(field.type) != "bool" for field in fields(config))


@dataclass(frozen=True, slots=True)
class _Sought:
    """Windows that a person should be in, by range; range of the person; whether clearly visible."""

    windows: Mapping[WindowRange, Box]
    kind: WindowRange
    is_plain: bool


@dataclass(slots=True, eq=False)
class WindowTally:
    """Results of a detector: times of images, people present, people found, and false positives."""

    timed: Stopwatch = field(default_factory=Stopwatch)
    people: int = 0
    found: int = 0
    false: int = 0

    def add(
        self, windows: Sequence[_Window], people: Sequence[_Sought], kinds: Sequence[WindowRange]
    ) -> None:
        """Add an image: detections, and people present; only people in some ranges must be found."""
        matches = [[_is_on(window, person) for window in windows] for person in people]
        wanted = [number for number, person in enumerate(people) if person.is_plain and person.kind in kinds]
        self.people += len(wanted)
        self.found += sum(any(matches[number]) for number in wanted)
        self.false += sum(not any(row[k] for row in matches) for k in range(len(windows)))

    def plain(self) -> dict[str, Any]:
        """Return the tally as plain data."""
        counts = {"people": self.people, "found": self.found, "false": self.false}
        return {"ms": self.timed.median_ms, "images": len(self.timed.times_ms)} | counts


def compare_windows(scenarios: Sequence[str], most_s: float, every: int) -> Result:
    """Detect people in the same images with all methods; times are those of one core.

    Args:
        scenarios: scenarios of the drives, with seed 0.
        most_s: maximum length [s].
        every: interval between images.

    Returns:
        Plain data: a tally by the key of the slide, or `BY_SIZE` with the ranges of people to be found;
        and "parts", the tracker's median times [ms].
    """
    comparison, threads = _Comparison(), cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        for name in scenarios:
            comparison.watch(shortened(name, most_s), every)
    finally:
        cv2.setNumThreads(threads)
    return comparison.plain()


def slide(image: Image, how: Slide) -> Floats:
    """Return windows (N, 4) with people in an image, after non-maximum suppression."""
    hog = cv2.HOGDescriptor(SIZES[how.kind], (16, 16), (8, 8), (8, 8), 9)
    machines = people_detector() if how.is_opencv else shipped_windows(sees_depth=False)
    hog.setSVMDetector(machines.weights[how.kind])
    # Grouping by OpenCV takes minutes for the thousands of hits of near windows.
    boxes, scores = hog.detectMultiScale(
        image,
        hitThreshold=0.0 if how.is_opencv else COLOUR_ONLY.least_score(how.kind),
        winStride=(how.shift_px, how.shift_px),
        padding=(8, 8),
        scale=how.scale,
        groupThreshold=0,
    )
    found = np.asarray(boxes, np.float64).reshape(-1, 4)
    kept = cv2.dnn.NMSBoxes(found.tolist(), np.ravel(scores).tolist(), 0.0, _DOUBLE) if len(found) else []
    return found[np.asarray(kept, np.int64).ravel()]


class _Comparison:
    def __init__(self) -> None:
        self.slides = {how: WindowTally() for how in (*FAR_SLIDES, *NEAR_SLIDES)}
        self.by_size: dict[tuple[WindowRange, ...], WindowTally] = {
            kinds: WindowTally() for kinds in (tuple(WindowRange), (WindowRange.FAR,), (WindowRange.NEAR,))
        }
        self.parts = {name: Stopwatch() for name in PARTS}
        self.detector = PreDetector(HumanSize(), UDepthConfig())

    def watch(self, scenario: Scenario, every: int) -> None:
        tracker, whole = make_choice(DEFAULT, stream(0, "reproduce.tracker")), Stopwatch()
        for moment, everybody in play_drive(scenario, 0):
            whole(partial(tracker.update, moment.frame))
            if moment.number % every == 0:
                view = DepthView.of(moment.frame.calibrations[DEPTH], DEPTH)
                people = _people(everybody, view, moment.frame.depth(DEPTH).shape)
                spent_ms = self._search_by_size(moment.frame, people, view)
                self.parts[PARTS[-1]].times_ms.append(whole.times_ms[-1] - spent_ms)
                self._search_by_sliding(moment.frame, people)

    def plain(self) -> dict[str, Any]:
        tallies = {how.key: tally.plain() for how, tally in self.slides.items()}
        tallies |= {f"{'+'.join(kinds)} {BY_SIZE}": tally.plain() for kinds, tally in self.by_size.items()}
        return tallies | {"parts": {name: part.median_ms for name, part in self.parts.items()}}

    def _search_by_size(self, frame: Frame, people: Sequence[_Sought], view: DepthView) -> float:
        """Detect windows as the tracker does; return them with the time [ms]."""
        detect, verify = (self.parts[name] for name in PARTS[:2])
        layout = detect(partial(self.detector, frame.depth(DEPTH), view))
        windows = verify(lambda: list(_verified(frame, layout, view)))
        spent_ms = detect.times_ms[-1] + verify.times_ms[-1]
        for kinds, tally in self.by_size.items():
            tally.timed.times_ms.append(spent_ms)
            tally.add(windows, people, kinds)
        return spent_ms

    def _search_by_sliding(self, frame: Frame, people: Sequence[_Sought]) -> None:
        for how, tally in self.slides.items():
            found = tally.timed(partial(slide, frame.rgb(DEPTH_COLOUR), how))
            tally.add([(how.kind, tuple(row)) for row in found.tolist()], people, (how.kind,))


def _verified(frame: Frame, layout: Layout, view: DepthView) -> Iterator[_Window]:
    model, depth, colour = shipped_windows(sees_depth=True), frame.depth(DEPTH), frame.rgb(DEPTH_COLOUR)
    for found in layout.detections:
        kind = range_of(found.z_m, layout.floor, view, len(depth))
        window = window_of(found.box, found.z_m, kind, layout.floor, view)
        if model.look(colour, depth, found.z_m, window, kind) > PARTICLES.least_score(kind):
            yield kind, window


def _people(everybody: Sequence[FloorPerson], view: DepthView, shape: tuple[int, ...]) -> list[_Sought]:
    """Return windows on all people in front of the camera, from ground truth."""
    floor, found = HeightLine(view.horizon_px / view.focal_px, view.height_m), []
    for person in everybody:
        camera_m = view.calibration.position_m[0]
        if person.truth.box is None or person.place_m[0] <= camera_m + _TORSO_M:
            continue
        z_m = person.place_m[0] - camera_m - _FRONT_M
        left, top, width, height = person.truth.box
        torso, middle = _TORSO_M * view.focal_px / z_m, left + width / 2.0
        box = (middle - torso / 2.0, top, torso, height)
        body = PreDetection(
            box=box, x_m=0.0, z_m=z_m, width_m=_TORSO_M, height_m=0.0, depth_m=0.0, probability=1.0
        )
        is_plain = person.is_counted and person.truth.occluded_fraction < _HIDDEN and 0.0 <= middle < shape[1]
        windows = {kind: window_of(body.box, body.z_m, kind, floor, view) for kind in WindowRange}
        found.append(_Sought(windows, range_of(z_m, floor, view, shape[0]), is_plain))
    return found


def _is_on(window: _Window, person: _Sought) -> bool:
    kind, box = window
    return float(iou(np.array(box), np.array(person.windows[kind]))) > _OVERLAP


def score_windows(scenario: str, seed: int) -> Result:
    """Collect windows of a scenario; return scores of people and others by range and classifier."""
    samples = collect_windows(scenario, seed, has_jitter=False)
    models = {
        OWN: shipped_windows(sees_depth=True),
        COLOUR: shipped_windows(sees_depth=False),
        OPENCV: people_detector(),
    }
    result: Result = {}
    for kind, name in MODELS:
        scores = scores_of(models[name], samples, WindowRange(kind)).round(3)
        is_person = samples.is_person(WindowRange(kind))
        people, others = scores[is_person].tolist(), scores[~is_person].tolist()
        result[f"{kind} {name}"] = {"people": people, "others": others}
    return result
