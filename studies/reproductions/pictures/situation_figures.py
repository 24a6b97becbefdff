"""People's ways before a depth camera, true and tracked: figures 4.25 to 4.33 of that thesis."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.truth.truth import PersonTruth
from peopleboy.studies.reproductions.evaluations.attention_focus import (
    FocusMoment,
    can_be_learned,
    play_focus,
    wanted,
)
from peopleboy.studies.reproductions.evaluations.scene_scores import (
    ADAPT,
    CLEAN,
    MEAN,
    ROBUST,
    TRACK,
    read_map,
)
from peopleboy.studies.reproductions.pictures.canvas import canvas, label
from peopleboy.tracker.attention.attend import PersonModel, attention_map, learn, search
from peopleboy.tracker.attention.attention_config import PRINTED, AttentionConfig
from peopleboy.tracker.attention.image_sums import Sight
from peopleboy.tracker.attention.part_model import HEAD, TORSO, Part
from peopleboy.tracker.track import Box

Floats = NDArray[np.float64]
Film = Mapping[str, Any]

_TRUE: Final = "#c62828"
_SIDEWAYS, _AHEAD = "#1f78b4", "#d95f02"
_IDS: Final = colormaps["tab10"]
_GAP: Final = 3  # frames that a way may miss before its line ends


def draw_ways(films: Mapping[str, Film], who: str) -> Figure:
    """Draw films' ways relative to the robot: who counts in red, tracks in a colour each."""
    columns = 3
    rows = math.ceil(len(films) / columns)
    figure = canvas(3.0 * rows)
    for number, (title, film) in enumerate(films.items(), 1):
        axes = figure.add_subplot(rows, columns, number)
        _draw_ways(axes, _counted(film), film[who]["told"])
        label(axes, title, "to the left [m]", "ahead [m]")
    return figure


def draw_world(film: Film, who: str) -> Figure:
    """Draw tracks in the world, and the way of the robot with where it looks."""
    figure = canvas(3.4)
    axes = figure.subplots()
    robot = np.array(film["robot"])
    axes.plot(robot[:, 0], robot[:, 1], "--", color=_TRUE, linewidth=1.2, label="robot")
    every = robot[:: max(len(robot) // 20, 1)]
    axes.quiver(
        every[:, 0],
        every[:, 1],
        np.cos(every[:, 2]),
        np.sin(every[:, 2]),
        color="#1f78b4",
        width=0.003,
        scale=40.0,
    )
    told = np.array(film[who]["told"]).reshape(-1, 4)
    pose = robot[told[:, 0].astype(int) - 1]
    cosine, sine = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    x = pose[:, 0] + cosine * told[:, 2] - sine * told[:, 3]
    y = pose[:, 1] + sine * told[:, 2] + cosine * told[:, 3]
    _lines(axes, np.stack([told[:, 0], told[:, 1], x, y], axis=1), as_plan=False)
    axes.set_aspect("equal")
    label(axes, "", "x [m]", "y [m]")
    axes.legend(fontsize=7, frameon=False)
    return figure


def draw_people(films: Mapping[str, Film], who: str) -> Figure:
    """Draw mean and deviation of each person's errors, sideways and ahead."""
    names, means, spreads = [], [], []
    for title, film in films.items():
        hits = np.array(film[who]["hits"], dtype=np.float64).reshape(-1, 7)
        off = np.abs(hits[:, [6, 5]])
        for person in np.unique(hits[:, 1]):
            own = off[(hits[:, 1] == person) & np.isfinite(off).all(axis=1)]
            if len(own):
                names.append(f"{title.split()[-1]},{person:.0f}")
                means.append(own.mean(axis=0))
                spreads.append(own.std(axis=0))
    figure = canvas(3.2)
    axes = figure.subplots()
    at = np.arange(len(names))
    for column, (name, colour) in enumerate((("x, sideways", _SIDEWAYS), ("z, ahead", _AHEAD))):
        axes.bar(
            at + 0.4 * column - 0.2,
            [mean[column] for mean in means],
            0.38,
            yerr=[spread[column] for spread in spreads],
            color=colour,
            label=name,
            error_kw={"linewidth": 0.7},
        )
    axes.set_xticks(at, names, rotation=90)
    axes.set_ylim(bottom=0.0)
    label(axes, "", "set, person", "error [m]")
    axes.legend(fontsize=7, frameon=False, ncols=2, loc="lower left", bbox_to_anchor=(0.0, 1.0))
    return figure


def draw_errors(film: Film, who: str) -> Figure:
    """Draw the distance of a film's first person over time, and the errors sideways and ahead."""
    hits = np.array(film[who]["hits"], dtype=np.float64).reshape(-1, 7)
    hits = hits[hits[:, 1] == hits[:, 1].min()]
    truth = np.array(film["truth"]).reshape(-1, 7)
    truth = truth[truth[:, 1] == hits[0, 1]]
    figure = canvas(4.0)
    above, below = figure.subplots(2, 1, sharex=True)
    above.plot(truth[:, 0], truth[:, 4], color=_TRUE, linewidth=1.2)
    label(above, "", "", "distance [m]")
    for column, name, colour in ((6, "x, sideways", _SIDEWAYS), (5, "z, ahead", _AHEAD)):
        below.plot(hits[:, 0], hits[:, column], color=colour, linewidth=0.9, label=name)
    below.axhline(0.0, color="#999999", linewidth=0.6)
    label(below, "", "image", "error [m]")
    below.legend(fontsize=7, frameon=False)
    return figure


def draw_crossing(film: Film, names: Mapping[str, str]) -> Figure:
    """Draw the true ways of a film beside those of several trackers, which `names` gives titles."""
    figure = canvas(3.2)
    first, *others = figure.subplots(1, 1 + len(names), sharex=True, sharey=True)
    _lines(first, _counted(film))
    label(first, "true", "to the left [m]", "ahead [m]")
    for axes, (who, title) in zip(others, names.items(), strict=True):
        _lines(axes, np.array(film[who]["told"]).reshape(-1, 4))
        label(axes, title, "to the left [m]")
    return figure


def draw_legs(film: Film) -> Figure:
    """Draw a person's way relative to the robot, and the distance over time: true, by depth, by legs."""
    truth = _counted(film)
    figure = canvas(3.6)
    left, right = figure.subplots(1, 2)
    for name, rows, colour in (
        ("true", truth, "#1f78b4"),
        ("depth and colour", np.array(film["depth"]).reshape(-1, 4), "#2e7d32"),
        ("legs", np.array(film["legs"]).reshape(-1, 4), _TRUE),
    ):
        size = 1.2 if name != "true" else 2.4
        left.plot(rows[:, 3], rows[:, 2], ".", markersize=size, color=colour, label=name)
        right.plot(rows[:, 0], np.hypot(rows[:, 2], rows[:, 3]), ".", markersize=size, color=colour)
    left.invert_xaxis()
    label(left, "", "to the left [m]", "ahead [m]")
    label(right, "", "image", "from the robot [m]")
    left.legend(fontsize=7, frameon=False, markerscale=4)
    return figure


def _draw_ways(axes: Axes, truth: Floats, told: Sequence[Sequence[float]]) -> None:
    _lines(axes, truth, colour=_TRUE, width=2.0)
    _lines(axes, np.array(told).reshape(-1, 4))


def _counted(film: Film) -> Floats:
    """Give frame, person and place (N, 4) of everybody who counts."""
    truth = np.array(film["truth"], dtype=np.float64).reshape(-1, 7)
    return np.asarray(truth[truth[:, 6] > 0.0][:, :4])


def _lines(
    axes: Axes, rows: Floats, colour: str | None = None, width: float = 1.0, *, as_plan: bool = True
) -> None:
    """Draw the way of each id of rows (N, 4), frame, id, x, y; on a plan x is up and y to the left."""
    for number, identity in enumerate(np.unique(rows[:, 1])):
        own = rows[rows[:, 1] == identity]
        breaks = np.flatnonzero(np.diff(own[:, 0]) > _GAP) + 1
        for part in np.split(own, breaks):
            x, y = (part[:, 3], part[:, 2]) if as_plan else (part[:, 2], part[:, 3])
            axes.plot(x, y, color=colour or _IDS(number % 10), linewidth=width)
    if as_plan and not axes.xaxis_inverted():
        axes.invert_xaxis()


# How attention finds a person: figures 5.6 to 5.9 of the thesis on situation awareness.

FOCUS_SCENE: Final = "crossing_3"
FOCUS_SEED: Final = 1
_MEANS: Final = replace(PRINTED, share="means")
_ALONE: Final = replace(AttentionConfig(), scales=(1.0,))
_FOUND: Final = "#1b9e77"
_LEARNED: Final = "#e7298a"


@dataclass(frozen=True, slots=True, eq=False)
class LearnedFilm:
    """A person who was learned, and later images of it.

    Attributes:
        moment: in which it was learned.
        person: who.
        later: further images.
    """

    moment: FocusMoment
    person: PersonTruth
    later: Sequence[FocusMoment]


def learned_films(
    scenario: str = FOCUS_SCENE, seed: int = FOCUS_SEED, every: int = 15
) -> Iterator[LearnedFilm]:
    """Give each person of a film with the first image that shows most of it."""
    loaded = load_scenario(scenario)
    moments = list(play_focus(loaded, seed, every))
    for number in sorted({one.id for moment in moments for one in wanted(loaded, moment.truth)}):
        for k, moment in enumerate(moments):
            person = next((one for one in moment.truth.people if one.id == number), None)
            if person is not None and can_be_learned(person, moment.image.shape):
                yield LearnedFilm(moment, person, moments[k + 1 :])
                break


def draw_excitation() -> Figure:
    """Draw what speaks for a torso, what against it, and what is left: figure 5.6."""
    first = next(learned_films())
    sight = Sight.of(first.moment.image, _MEANS)
    known = dict(learn(sight, _box_of(first.person), _MEANS).parts)[TORSO]
    assert sight.maps is not None
    page = canvas(1.7)
    image, *axes = page.subplots(1, 4)
    _show(image, first.moment.image, "image, and the learned box")
    _frame(image, _box_of(first.person), _LEARNED)
    sums = (sight.maps @ known.excites.astype(np.float32), sight.maps @ known.inhibits.astype(np.float32))
    maps: list[NDArray[np.floating]] = [*sums, attention_map(sight, known, _MEANS)]
    names = ("a) excitation E", "b) inhibition I", "c) A = E - I, above 0")
    for one, map_, name in zip(axes, maps, names, strict=True):
        _show(one, map_, name)
    return page


def draw_part_scores() -> Figure:
    """Draw the scores of torso, head and patterns, and of the whole person: figure 5.7."""
    first = next(learned_films())
    page = canvas(2.9)
    ways = ((_MEANS, "as printed, means"), (_ALONE, "default"))
    for row, (config, name) in zip(page.subplots(2, 5), ways, strict=True):
        sight = Sight.of(first.moment.image, config)
        focus = search(sight, learn(sight, _box_of(first.person), config), config)
        head, torso = focus.parts
        _show(row[0], first.moment.image, name)
        for part in (HEAD, TORSO):
            _frame(row[0], _part_box(part, _box_of(first.person)), _LEARNED)
        maps = (torso.features, head.features, torso.patterns, focus.scores)
        for axes, map_, title in zip(row[1:], maps, ("torso", "face", "patterns", "person"), strict=True):
            assert map_ is not None
            _show(axes, map_, title)
    return page


def draw_focus_paths() -> Figure:
    """Draw where the focus goes for each of three people, from image to image: figure 5.8."""
    films = list(learned_films(every=5))
    page = canvas(4.2)
    for (above, below), film in zip(page.subplots(2, len(films)).T, films, strict=True):
        sight = Sight.of(film.moment.image, _ALONE)
        look = learn(sight, _box_of(film.person), _ALONE)
        _show(above, search(sight, look, _ALONE).scores, f"score, {film.person.name}")
        _show(below, film.later[-1].image, "way of the focus")
        ways = np.array([_place(moment, look) for moment in film.later])
        below.plot(ways[:, 0], ways[:, 1], "-", color=_FOUND, linewidth=1.0)
        below.plot(*ways[-1], "+", color=_LEARNED, markersize=9, markeredgewidth=1.8)
    return page


def draw_examples() -> Figure:
    """Draw all maps of a few images, and the place that comes of them: figure 5.9."""
    film = next(iter(learned_films("follow_passers_by", 0, 60)))
    sight = Sight.of(film.moment.image, AttentionConfig())
    look = learn(sight, _box_of(film.person), AttentionConfig())
    shown = film.later[1:11:2]
    page = canvas(7.0)
    grid = page.subplots(5, len(shown))
    for column, moment in zip(grid.T, shown, strict=True):
        focus = search(Sight.of(moment.image, AttentionConfig()), look, AttentionConfig())
        head, torso = focus.parts
        maps = (head.features, torso.features, torso.patterns, focus.scores)
        for axes, map_, title in zip(column[1:], maps, ("face", "torso", "patterns", "person"), strict=True):
            assert map_ is not None
            _show(axes, map_, title)
        _show(column[0], moment.image, f"{moment.time_s:.0f} s, score {focus.score:.2f}")
        _frame(column[0], focus.box, _FOUND)
    return page


def _place(moment: FocusMoment, look: PersonModel) -> tuple[float, float]:
    return search(Sight.of(moment.image, _ALONE), look, _ALONE).place


def _box_of(person: PersonTruth) -> Box:
    assert person.box is not None  # it can be learned
    return person.box


def _part_box(part: Part, box: Box) -> Box:
    left, top, width, height = box
    wide = part.width * height
    return left + (width - wide) / 2.0, top + part.top * height, wide, part.height * height


def _show(axes: Axes, picture: NDArray[np.number], title: str) -> None:
    # What is outside is 0 in scores; likely places differ little in some.
    lowest = np.percentile(picture[picture > 0], 1.0) if picture.ndim == 2 and (picture > 0).any() else None
    axes.imshow(picture, cmap="inferno", interpolation="nearest", vmin=lowest)
    label(axes, title)
    axes.set_axis_off()


def _frame(axes: Axes, box: Box, colour: str) -> None:
    left, top, width, height = box
    axes.add_patch(Rectangle((left, top), width, height, fill=False, edgecolor=colour, linewidth=1.3))


# Backgrounds that scene models learned, beside the truth: figures 3.8 to 3.13 of that thesis.

_SHOWN: Final = {CLEAN: "truth", MEAN: MEAN, TRACK: TRACK, ADAPT: ADAPT, ROBUST: ROBUST}
_NEAREST_M, _FARTHEST_M = 1.5, 7.0
_UNKNOWN: Final = "#000000"


def draw_maps(films: Mapping[str, Mapping[str, str]]) -> Figure:
    """Draw a row for each film: the truth, and the depth that each model takes for background."""
    figure = canvas(1.45 * len(films))
    colours = colormaps["viridis_r"].with_extremes(bad=_UNKNOWN)
    grid = figure.subplots(len(films), len(_SHOWN), squeeze=False)
    for row, (title, maps) in zip(grid, films.items(), strict=True):
        for axes, name in zip(row, _SHOWN, strict=True):
            depth = read_map(maps[name])
            shown = np.ma.masked_equal(depth, 0.0)
            axes.imshow(shown, cmap=colours, vmin=_NEAREST_M, vmax=_FARTHEST_M, interpolation="nearest")
            axes.set_xticks([])
            axes.set_yticks([])
        row[0].set_ylabel(title, fontsize=8)
    for axes, words in zip(grid[0], _SHOWN.values(), strict=True):
        axes.set_title(words, fontsize=8)
    return figure
