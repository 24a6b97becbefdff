"""Picture of attention: the score map while a person is absent, and the similarity of people to her."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from docs.generate.pictures.paper import show
from peopleboy.scenarios.drawing.palette import track_colour
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.sim.cameras.camera_config import calibrations_of
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame
from peopleboy.tracker.reproductions.attention.attend import Focus
from peopleboy.tracker.reproductions.attention.attentive_explanation import Attended
from peopleboy.tracker.reproductions.attention.attentive_tracker import AttentiveConfig, AttentiveTracker
from peopleboy.tracker.reproductions.attention.person_views import PersonView, box_in
from peopleboy.tracker.reproductions.attention.recogniser import ByColour
from peopleboy.tracker.track import Box, Status, Track
from peopleboy.tracker.trackers import DEFAULT_TRACKER, make_tracker
from peopleboy.tracker.tracking.appearance import Colours, colour_similarity

SCENARIO, SEED = "absence_10s", 0
SHOWN_S = (3.0, 13.5, 24.0)
FOCUS = "#e7298a"
_LEARNED = 15  # images of the person whose colours are averaged


@dataclass(frozen=True, slots=True)
class _Moment:
    time_s: float
    image: NDArray[np.uint8]
    tracks: list[tuple[int, Box]]
    focus: Focus


@dataclass(slots=True)
class _Film:
    moments: list[_Moment] = field(default_factory=list)
    likeness: dict[int, list[tuple[float, float]]] = field(default_factory=lambda: defaultdict(list))
    away_s: list[float] = field(default_factory=list)


def absence() -> Figure:
    """Draw images and score maps before, during and after her absence, and everyone's similarity to her."""
    film = _watch()
    figure = Figure(figsize=(7.6, 5.6), layout="constrained")
    grid = figure.add_gridspec(3, len(film.moments), height_ratios=(1.0, 1.0, 1.1))
    for column, moment in enumerate(film.moments):
        _draw_image(figure.add_subplot(grid[0, column]), moment)
        axes = figure.add_subplot(grid[1, column])
        axes.imshow(np.sqrt(moment.focus.scores), cmap="inferno", vmin=0.0, vmax=1.0)
        axes.set_axis_off()
        axes.set_title(f"score map, maximum {moment.focus.score:.2f}", fontsize=9)
    _draw_likeness(figure.add_subplot(grid[2, :]), film)
    return figure


def _watch() -> _Film:
    scenario, film = load_scenario(SCENARIO), _Film()
    calibrations = calibrations_of(scenario.world(SEED).robot.cameras)
    tracker = AttentiveTracker(make_tracker(DEFAULT_TRACKER, SEED), ByColour())
    before, look, seen = None, None, 0
    for world, observation in blind_drive(scenario, SEED):
        frame = Frame.from_observation(observation, before, calibrations)
        before, tracks = observation.odometry, tracker.update(frame)
        attended = tracker.explanation.attended
        if attended is None:
            continue
        looks = dict(_looks(tracks, frame))
        if attended.number in looks and seen < _LEARNED:
            look = ByColour().learned(look, looks[attended.number], 1.0 / (seen := seen + 1))
        if look is not None and seen == _LEARNED:
            for number, one in looks.items():
                film.likeness[number].append((frame.time_s, colour_similarity(look, one)))
        if world.truth().people[0].visible_fraction < 0.3:
            film.away_s.append(frame.time_s)
        if len(film.moments) < len(SHOWN_S) and frame.time_s >= SHOWN_S[len(film.moments)]:
            film.moments.append(_moment(attended, tracks, frame))
    return film


def _looks(tracks: tuple[Track, ...], frame: Frame) -> list[tuple[int, Colours]]:
    found = []
    for track in tracks:
        box = box_in(COLOUR, track, frame)
        look = None if box is None else ByColour().see(PersonView(COLOUR, frame.rgb(COLOUR), box))
        if look is not None and track.status is Status.TRACKED and THERMAL in track.boxes:
            found.append((track.id, look))
    return found


def _moment(attended: Attended, tracks: tuple[Track, ...], frame: Frame) -> _Moment:
    boxes = [(track.id, box_in(COLOUR, track, frame)) for track in tracks if track.status is Status.TRACKED]
    told = [(number, box) for number, box in boxes if box is not None]
    return _Moment(frame.time_s, frame.rgb(COLOUR), told, attended.focus())


def _draw_image(axes: Axes, moment: _Moment) -> None:
    show(axes, moment.image)
    axes.set_title(f"{moment.time_s:.1f} s", fontsize=9)
    for number, (left, top, width, height) in moment.tracks:
        colour = _colour(number)
        axes.add_patch(Rectangle((left, top), width, height, fill=False, edgecolor=colour, lw=1.3))
        axes.text(left, top - 6, str(number), color=colour, fontsize=8, clip_on=True)
    axes.set(xlim=(-0.5, moment.image.shape[1] - 0.5), ylim=(moment.image.shape[0] - 0.5, -0.5))
    axes.set_axis_off()
    axes.plot(*moment.focus.place, "+", color=FOCUS, markersize=10, markeredgewidth=1.8)


def _draw_likeness(axes: Axes, film: _Film) -> None:
    for number, rows in sorted(film.likeness.items()):
        times, likeness = np.array(rows).T
        axes.plot(times, likeness, ".", markersize=3, color=_colour(number), label=f"track {number}")
    axes.axhline(AttentiveConfig().accept, color="#555555", lw=0.8, ls="--")
    axes.axvspan(film.away_s[0], film.away_s[-1], color="#000000", alpha=0.08, lw=0)
    axes.set(ylim=(0.0, 1.03), xlabel="time [s]; grey: person absent", ylabel="similarity")
    axes.tick_params(labelsize=8)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(fontsize=7, frameon=False, ncols=4, loc="lower left")


def _colour(number: int) -> tuple[float, ...]:
    return tuple(share / 255 for share in track_colour(number))
