"""CPU time of the contour tracker by parts and people, and of trackers compared with OpenCV's HOG."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from statistics import mean, median

import cv2
import numpy as np

from benchmarks.compare import Turns, median_ms, spent_ms, timed_ms
from benchmarks.peers.detectors import Hog
from peopleboy.random_streams import stream
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.world import SimulatedWorld
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame, Odometry
from peopleboy.tracker.reproductions.contour.appearance.appearance_model import ColourModel, likelihood
from peopleboy.tracker.reproductions.contour.box_interaction import overlap_shares, person_factor, regions_of
from peopleboy.tracker.reproductions.contour.contour_tracker import ContourTracker
from peopleboy.tracker.reproductions.contour.explanation import DETECTOR_KEY
from peopleboy.tracker.reproductions.contour.measurement.likelihood import (
    ContourModel,
    covered_by,
    seen_shares,
)
from peopleboy.tracker.reproductions.contour.particle_filter import FrameView, begin, step, view_frame, weigh
from peopleboy.tracker.reproductions.contour.particles import mean_state, predict, resample
from peopleboy.tracker.reproductions.contour.variants import CONTOUR
from peopleboy.tracker.track import Status
from peopleboy.tracker.trackers import CONTOUR_TRACKER, DEFAULT_TRACKER, make_tracker

SCENARIO = "crossing_4"  # with partial and total occlusions
MOST = 4
STEP_S = 1 / 15
SHAPE = (240, 320)
SAMPLES = 1000
HOG, FILTER_STEP = "HOG", "filter step"
_TURN_FRAMES = 10  # consecutive frames per turn of a tracker
_TURN_STEPS = 100  # steps per turn of the filter; HOG runs once per turn
_WARM_UP_STEPS = 10


@dataclass(frozen=True, slots=True, kw_only=True)
class CrowdTime:
    """Time of a frame by number of people.

    Attributes:
        people: number of people.
        frame_ms: [ms] CPU time of the tracker, median over the frames in which each person has a filter.
        frames: number of those frames.
        tracked: mean number of tracked people in them.
    """

    people: int
    frame_ms: float
    frames: int
    tracked: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ContourTimes:
    """Times of the contour tracker.

    Attributes:
        crowds: times by number of people, from 0.
        prepare_ms: [ms] preparation of a frame, common to all filters.
        parts_ms: [ms] times of the parts, for one person with 1000 samples in the largest crowd.
    """

    crowds: tuple[CrowdTime, ...]
    prepare_ms: float
    parts_ms: Mapping[str, float]

    @property
    def person_ms(self) -> float:
        """Time per additional person: the slope over the crowds."""
        return float(np.polyfit([c.people for c in self.crowds], [c.frame_ms for c in self.crowds], 1)[0])


class FilterStep:
    """Particle filter on a drawn person at 320x240; each call predicts, weights, estimates and resamples.

    The preparation of the frame, which all filters share, is not included.
    """

    def __init__(self, count: int) -> None:
        self._config = replace(CONTOUR, person=replace(CONTOUR.person, count=count))
        self._rng = np.random.default_rng(0)
        frame = Frame(images={THERMAL: _drawn_person()}, time_s=0.0, odometry=Odometry(turn_rad=0.01))
        model = ContourModel.build(SHAPE, self._config.contour)
        self._view = view_frame(frame, STEP_S, model, self._config)
        self._belief = begin(self._view, self._config.detector, self._config, self._rng)
        self()  # which may compile

    def __call__(self) -> None:
        """Run the filter on the next frame."""
        self._belief = step(self._belief.core, self._view, self._config.person, self._config, self._rng)


def step_time_ms(count: int, steps: int = 300) -> float:
    """Return the median CPU time [ms] of one step with a number of samples."""
    follow = FilterStep(count)
    return median([spent_ms(follow) for _ in range(steps)][_WARM_UP_STEPS:])


def films() -> tuple[Sequence[Frame], ...]:
    """Record crowds of 0 to 4 people."""
    return tuple(list(shoot(SCENARIO, people)) for people in range(MOST + 1))


def shoot(scenario: str, people: int | None = None, seed: int = 0) -> Iterator[Frame]:
    """Render the frames of a scenario with its first people, or all of them, and a standing robot."""
    loaded = load_scenario(scenario)
    config = loaded.world(seed)
    before = None
    with SimulatedWorld(replace(config, people=config.people[:people])) as world:
        for _ in range(round(loaded.duration_s * config.control_hz)):
            observation = world.observe()
            frame = Frame.from_observation(observation, before)
            yield replace(frame, images={name: frame.images[name] for name in (THERMAL, COLOUR)})
            before = observation.odometry
            world.step(0.0, 0.0)


def contour_times(crowds: Sequence[Sequence[Frame]]) -> ContourTimes:
    """Time the tracker on crowds of 0 to 4 people."""
    film = crowds[-1]
    return ContourTimes(
        crowds=tuple(_crowd_time(film, people) for people, film in enumerate(crowds)),
        prepare_ms=median_ms([partial(_view_of, frame) for frame in film]),
        parts_ms=_parts_ms(film),
    )


def _crowd_time(film: Sequence[Frame], people: int) -> CrowdTime:
    tracker = make_tracker(CONTOUR_TRACKER)
    times, tracked = [], []
    for frame in film:
        frame_ms, tracks = timed_ms(partial(tracker.update, frame))
        if len(people_in(tracker)) == people:
            times.append(frame_ms)
            tracked.append(sum(track.status is not Status.TENTATIVE for track in tracks))
    return CrowdTime(people=people, frame_ms=median(times), frames=len(times), tracked=mean(tracked))


def people_in(tracker: ContourTracker) -> list[int]:
    """Return the ids of the people with a filter."""
    return [key for key in tracker.explanation.particles if key != DETECTOR_KEY]


def _parts_ms(film: Sequence[Frame]) -> dict[str, float]:
    """Time the parts with the samples of people in the middle of a sequence, each person first in turn."""
    tracker = make_tracker(CONTOUR_TRACKER)
    for frame in film[: len(film) // 2]:
        tracker.update(frame)
    view = _view_of(film[len(film) // 2])
    each = [_person_works(tracker, number, view) for number in people_in(tracker)]
    parts = {name: median_ms([works[name] for works in each] * 50) for name in each[0]}
    # Weighting needs the measurements.
    parts["weights, estimate"] -= parts["measure contour"]
    return parts


def _view_of(frame: Frame) -> FrameView:
    model = _model_of(*frame.grey(THERMAL).shape)
    return view_frame(frame, STEP_S, model, CONTOUR)


@cache
def _model_of(height_px: int, width_px: int) -> ContourModel:
    return ContourModel.build((height_px, width_px), CONTOUR.contour)


def _person_works(tracker: ContourTracker, number: int, view: FrameView) -> dict[str, Callable[[], object]]:
    config, rng = CONTOUR, stream(0, "tracker")
    clouds = tracker.explanation.particles
    cloud, state = clouds[number], clouds[number].state
    estimate = mean_state(cloud)
    others = [mean_state(clouds[other]) for other in people_in(tracker) if other != number]
    appearance, colour = view.appearance, config.colour
    assert appearance is not None
    assert colour is not None
    known = ColourModel.begin(appearance.describe(estimate.astype(np.float32)[None])[0], colour)
    strength = np.full(len(others), config.interaction.penalty)
    rows = resample(cloud, len(cloud), rng)

    def occlusion() -> object:
        image = covered_by(view.image, others[:1], config.depth.growth)
        seen_shares(image, estimate, view.model.probes)
        return person_factor(overlap_shares(state, regions_of(others, config), config), strength)

    return {
        "resample": lambda: resample(cloud, len(cloud), rng),
        "motion": lambda: predict(state, rows, STEP_S, view.turn, view.size, config.motion, rng),
        "measure contour": lambda: view.model.differences(view.image, state),
        "weights, estimate": lambda: weigh(state, view, config.person, config),
        "colour and appearance": lambda: likelihood(appearance.describe(state), known, colour),
        "occlusion": occlusion,
    }


def beside_hog(film: Sequence[Frame]) -> Turns:
    """Time the trackers on four people, in turn with a filter and single-threaded HOG [ms].

    Times of contour tracker and filter are medians over a turn's frames. That of the default tracker is the
    mean, since some of its frames take longer than others.
    """
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        return _turns(film)
    finally:
        cv2.setNumThreads(threads)


def _turns(film: Sequence[Frame]) -> Turns:
    trackers = {name: make_tracker(name) for name in (CONTOUR_TRACKER, DEFAULT_TRACKER)}
    hog, follow, turns = Hog(uses_colour=True), FilterStep(SAMPLES), Turns()
    hog.detect(film[0])
    for first in range(0, len(film), _TURN_FRAMES):
        frames = Turns()
        for frame in film[first : first + _TURN_FRAMES]:
            spent = {name: spent_ms(partial(one.update, frame)) for name, one in trackers.items()}
            if len(people_in(trackers[CONTOUR_TRACKER])) == MOST:
                frames.add(spent)
        step_ms = median(spent_ms(follow) for _ in range(_TURN_STEPS))
        hog_ms = spent_ms(partial(hog.detect, film[first]))
        if frames.values:
            contour_ms, default_ms = frames.median(CONTOUR_TRACKER), mean(frames.values[DEFAULT_TRACKER])
            turns.add(
                {CONTOUR_TRACKER: contour_ms, DEFAULT_TRACKER: default_ms, FILTER_STEP: step_ms, HOG: hog_ms}
            )
    return turns


def _drawn_person() -> np.ndarray:
    v, u = np.mgrid[: SHAPE[0], : SHAPE[1]]
    body = ((u - 160) / 18) ** 2 + ((v - 130) / 42) ** 2 < 1
    head = ((u - 160) / 7) ** 2 + ((v - 78) / 10) ** 2 < 1
    return np.where(head, 210, np.where(body, 120, 10)).astype(np.uint8)
