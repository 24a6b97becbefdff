"""Measure computing times: of the trackers' steps on a synthetic image, and of attention."""

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from statistics import median
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.random_streams import stream
from peopleboy.studies.reproductions.experiment import Line, Samples
from peopleboy.studies.reproductions.tracker_settings import TrackerSetting
from peopleboy.studies.reproductions.units import Measurement, Unit
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame, Odometry
from peopleboy.tracker.reproductions.attention.attend import learn, search
from peopleboy.tracker.reproductions.attention.attention_config import PRINTED, AttentionConfig
from peopleboy.tracker.reproductions.attention.feature_maps import feature_maps
from peopleboy.tracker.reproductions.attention.image_sums import ImageSums
from peopleboy.tracker.reproductions.attention.person_views import PersonView
from peopleboy.tracker.reproductions.attention.recogniser import ByColour
from peopleboy.tracker.reproductions.contour.appearance.appearance_model import ColourModel, likelihood
from peopleboy.tracker.reproductions.contour.appearance.colour_view import ColourView, PowerSums
from peopleboy.tracker.reproductions.contour.colour_config import ColourDescriptorConfig
from peopleboy.tracker.reproductions.contour.contour_config import TrackerConfig
from peopleboy.tracker.reproductions.contour.explanation import ContourExplanation
from peopleboy.tracker.reproductions.contour.measurement.likelihood import ContourModel, fitness, probability
from peopleboy.tracker.reproductions.contour.particle_filter import (
    advance,
    begin,
    is_within,
    sample_weights,
    step,
    view_frame,
)
from peopleboy.tracker.reproductions.contour.particles import (
    Particles,
    limits_px,
    mean_state,
    predict,
    resample,
    uncertainty_px2,
)
from peopleboy.tracker.trackers import Tracker, explanation_of

MS: Final = "ms"
TURNS: Final = 5
"""Number of times that a table is measured."""
SHAPE = (240, 320)
COUNT = 1000
Milliseconds = dict[str, float]


def drawn_people(count: int) -> NDArray[np.uint8]:
    """Return an image (240, 320) of warm people side by side on a cool background."""
    v, u = np.mgrid[: SHAPE[0], : SHAPE[1]]
    image = np.full(SHAPE, 30, dtype=np.uint8)
    for number in range(count):
        x = SHAPE[1] * (number + 1) / (count + 1)
        body = ((u - x) / 15) ** 2 + ((v - 130) / 42) ** 2 < 1
        legs = (abs(u - x) < 11) & (v > 130) & (v < 216)
        head = ((u - x) / 7) ** 2 + ((v - 79) / 10) ** 2 < 1
        image[body | legs] = 130
        image[head] = 210
    return image


def frame_of(people: int, time_s: float = 0.0) -> Frame:
    """Return a frame with drawn people in both images."""
    thermal = drawn_people(people)
    images = {THERMAL: thermal, COLOUR: np.stack([thermal] * 3, axis=-1)}
    return Frame(images=images, time_s=time_s, odometry=Odometry())


def milliseconds(work: Callable[[], object], steps: int) -> float:
    """Return the median processor time [ms] over many calls, after a few to warm up."""
    for _ in range(5):
        work()
    times = []
    for _ in range(steps):
        start = time.process_time_ns()
        work()
        times.append(time.process_time_ns() - start)
    return median(times) / 1e6


def time_steps(setting: TrackerSetting, steps: int) -> Milliseconds:
    """Time the steps of one filter with 1000 samples (thesis, table 4.1)."""
    config = replace(setting.config(), colour=None, appearance=None)
    person, rng = replace(config.person, count=COUNT), stream(0, "reproduce.timing")
    view = view_frame(frame_of(1), 1 / 15, ContourModel.build(SHAPE, config.contour), config)
    belief = begin(view, person, config, rng)
    state = advance(belief.particles, view, person, config, rng)
    differences = view.model.differences(view.image, state)

    def weigh() -> Particles:
        fit = fitness(differences, view.model.weights, config.likelihood)
        chance = probability(fit, config.likelihood)
        inside = is_within(state, limits_px(SHAPE[0], person.limits))
        weight = sample_weights(fit, chance, inside, config.likelihood.model, person)
        return Particles(state, weight)

    particles = weigh()
    kept = np.arange(COUNT)
    works: dict[str, Callable[[], object]] = {
        "resampling": lambda: resample(particles, COUNT, rng),
        "motion model": lambda: predict(state, kept, 1 / 15, view.turn, 1.0, config.motion, rng),
        "measuring": lambda: view.model.differences(view.image, state),
        "weight calculation": weigh,
        "estimate uncertainty": lambda: (mean_state(particles), uncertainty_px2(particles)),
        "total": lambda: step(belief.core, view, person, config, rng),
    }
    return {name: milliseconds(work, steps) for name, work in works.items()}


def time_counts(setting: TrackerSetting, steps: int) -> Milliseconds:
    """Time one step of a filter with a reduced and the default number of samples (thesis, section 4.4)."""
    config = replace(setting.config(), colour=None, appearance=None)
    return {str(count): _time_colour(config, None, steps, count) for count in (300, COUNT)}


def time_attention(setting: TrackerSetting, steps: int) -> Milliseconds:
    """Time the search for a person in an image of 320 x 240 by attention, as printed and by default."""
    config = PRINTED if setting.base == "printed" else AttentionConfig()
    noise = stream(0, "reproduce.timing").integers(0, 256, (*SHAPE, 3), dtype=np.uint8)
    image = np.asarray(cv2.GaussianBlur(noise, (0, 0), 6.0), np.uint8)
    box = (130.0, 60.0, 40.0, 130.0)
    sight, alone = ImageSums.of(image, config), AttentionConfig(maps=False)
    look, colours = learn(sight, box, config), learn(ImageSums.of(image, alone), box, alone)
    view = PersonView(COLOUR, image, box)
    works: dict[str, Callable[[], object]] = {
        "maps": lambda: feature_maps(image, config),
        "maps, patterns and their sums": lambda: ImageSums.of(image, config),
        "learning": lambda: learn(sight, box, config),
        "search": lambda: search(sight, look, config),
        "ratio of colours alone": lambda: search(ImageSums.of(image, alone), colours, alone),
        "colour descriptor": lambda: ByColour().see(view),
    }
    return {name: milliseconds(work, steps) for name, work in works.items()}


def time_people(setting: TrackerSetting, steps: int) -> Milliseconds:
    """Time whole frames with none to four people, per filter of 1000 samples (thesis, table 5.1)."""
    return {
        "detector only" if people == 0 else str(people): _time_crowd(setting, people, steps)
        for people in range(5)
    }


def _time_crowd(setting: TrackerSetting, people: int, steps: int) -> float:
    """Return the time of frames in which every person has a filter, per filter [ms]; NaN without any."""
    tracker = setting.make(stream(0, "reproduce.timing"))
    image, times = frame_of(people), []
    for number in range(60 * (people + 1) + 10 * steps):
        before, start = _clouds(tracker), time.process_time_ns()
        tracker.update(replace(image, time_s=number / 15))
        spent = time.process_time_ns() - start
        if before == _clouds(tracker) == people + 1:
            times.append(spent)
    return median(times[-steps:]) / 1e6 / (people + 1) if len(times) >= steps else float("nan")


def _clouds(tracker: Tracker) -> int:
    """Return the number of a contour tracker's filters."""
    explanation = explanation_of(tracker)
    assert isinstance(explanation, ContourExplanation)
    return len(explanation.particles)


_PICTURES: Mapping[str, tuple[int, int]] = {
    "greyscale": (1, 1),
    "colour (RGB)": (3, 1),
    "colour (RGB), 2nd degree": (3, 2),
    "colour (RGB), 3rd degree": (3, 3),
}


def time_integrals(setting: TrackerSetting, steps: int) -> Milliseconds:
    """Time the integral images of 320 by 240 pixels, whatever the tracker (thesis, table 6.1)."""
    del setting
    picture = np.ascontiguousarray(np.stack([drawn_people(2)] * 3, axis=-1))
    grey = np.ascontiguousarray(picture[..., :1])
    return {
        name: milliseconds(partial(PowerSums.build, grey if channels == 1 else picture, degree), steps)
        for name, (channels, degree) in _PICTURES.items()
    }


_COLOURS: Mapping[str, ColourDescriptorConfig | None] = {
    "gradient": None,
    "greyscale": ColourDescriptorConfig(representation="moments1", space="grey"),
    "first moment": ColourDescriptorConfig(representation="moments1"),
    "first two moments": ColourDescriptorConfig(representation="moments2"),
    "first three moments": ColourDescriptorConfig(representation="moments3"),
    "histogram (20 bins)": ColourDescriptorConfig(representation="histogram"),
}


def time_colours(setting: TrackerSetting, steps: int) -> Milliseconds:
    """Time one step of a filter with 1000 samples and its colours described in several ways (table 6.2)."""
    config = setting.config()
    return {
        # A histogram takes so long that a few steps are enough.
        name: _time_colour(config, colour, steps if name != "histogram (20 bins)" else 5)
        for name, colour in _COLOURS.items()
    }


def _time_colour(
    config: TrackerConfig, colour: ColourDescriptorConfig | None, steps: int, count: int = COUNT
) -> float:
    config = replace(config, colour=None, appearance=None)
    person, rng = replace(config.person, count=count), stream(0, "reproduce.timing")
    frame = frame_of(1)
    view = view_frame(frame, 1 / 15, ContourModel.build(SHAPE, config.contour), config)
    belief = begin(view, person, config, rng)
    for _ in range(10):
        belief = step(belief.core, view, person, config, rng)

    def work() -> object:
        after = step(belief.core, view, person, config, rng)
        if colour is None:
            return after
        picture = ColourView.build(frame.rgb(COLOUR), SHAPE, colour)
        features = picture.describe(after.particles.state)
        return likelihood(features, ColourModel.begin(features[0], colour), colour)

    return milliseconds(work, steps)


TIMES: Final[Mapping[str, Callable[[TrackerSetting, int], Milliseconds]]] = {
    "steps": time_steps,
    "counts": time_counts,
    "people": time_people,
    "integrals": time_integrals,
    "colours": time_colours,
    "attention": time_attention,
}
"""Timings by their name in declarations."""


def time_named(times: str, base: str, steps: int) -> Milliseconds:
    """Times the steps of a tracker, each this many times."""
    return TIMES[times](TrackerSetting(base), steps)


def timing(using: Measurement, *, times: str, trackers: Mapping[str, str]) -> Samples:
    """Time every step of trackers, several times.

    Args:
        using: the plan and stored results.
        times: the kind of timing, as in `TIMES`.
        trackers: base by the column's name.
    """
    steps = using.plan.timing_steps
    units = {
        name: [
            # Times are exact only where a unit runs alone.
            Unit(
                f"time {times} | {name}: {base} | {steps} | {turn}",
                time_named,
                (times, base, steps),
                is_timing=True,
            )
            for turn in range(TURNS)
        ]
        for name, base in trackers.items()
    }
    return {
        Line(step, name): {MS: np.array([turn[step] for turn in turns])}
        for name, turns in using.grouped(units).items()
        for step in turns[0]
    }
