"""Draw the figures of the thesis on situation awareness: tracked drives, scene models and attention."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.truth.truth import PersonTruth
from peopleboy.studies.reproductions.canvas import (
    BLUE,
    GREEN,
    ORANGE,
    PINK,
    RED,
    canvas,
    frame_box,
    label,
    show_image,
    single,
)
from peopleboy.studies.reproductions.experiments.attention import can_be_learned, play_focus, wanted
from peopleboy.studies.reproductions.experiments.drive_scores import hit_rows
from peopleboy.studies.reproductions.experiments.drive_tracking import (
    CHOICES,
    DEFAULT,
    FILTERS,
    NO_DEPTH,
    SETS,
    set_name,
    watch_drive,
)
from peopleboy.studies.reproductions.experiments.drives import MAIN, legs_run
from peopleboy.studies.reproductions.experiments.playback import Moment, unbroken
from peopleboy.studies.reproductions.experiments.scenes import (
    ADAPT,
    CLEAN,
    MEAN,
    ROBUST,
    SHOWN,
    TOF,
    TRACK,
    read_map,
    watch_scene,
)
from peopleboy.studies.reproductions.units import Measurement, Unit
from peopleboy.tracker.frame import COLOUR
from peopleboy.tracker.reproductions.attention.attend import PersonModel, attention_map, learn, search
from peopleboy.tracker.reproductions.attention.attention_config import PRINTED, AttentionConfig
from peopleboy.tracker.reproductions.attention.image_sums import ImageSums
from peopleboy.tracker.reproductions.attention.part_model import HEAD, TORSO, ModelPart
from peopleboy.tracker.track import Box

Floats = NDArray[np.float64]
Film = Mapping[str, Any]

_AXES: Final = {5: ("z, ahead", ORANGE), 6: ("x, sideways", BLUE)}
"""Columns of hits with errors to the visible surface."""
_IDS: Final = colormaps["tab10"]
_GAP: Final = 3  # frames that a track may miss before its line ends

_SHOWN: Final = {CLEAN: "truth", MEAN: MEAN, TRACK: TRACK, ADAPT: ADAPT, ROBUST: ROBUST}
_NEAREST_M, _FARTHEST_M = 1.5, 7.0

FOCUS_SCENE: Final = "crossing_3"
_ALONE: Final = replace(AttentionConfig(), scales=(1.0,))


def draw_drives(using: Measurement, *, figure: str, sets: Sequence[int]) -> Figure | None:
    """Draw some sets, each played with seed 0; None if a plan omits all of them."""
    names = tuple(CHOICES) if figure == "crossing" else MAIN
    shown = [number for number in sets if number in using.plan.sets]
    most_s = using.plan.drive_s
    runs = using.results(Unit.of(watch_drive, SETS[n - 1], 0, names, 1.0, most_s) for n in shown)
    return _FIGURES[figure](dict(zip(map(set_name, shown), runs, strict=True))) if runs else None


def draw_paths(films: Mapping[str, Film]) -> Figure:
    """Draw paths relative to the robot: counted people in red, each track in its own colour."""
    columns = 3
    rows = math.ceil(len(films) / columns)
    figure = canvas(3.0 * rows)
    for number, (title, film) in enumerate(films.items(), 1):
        axes = figure.add_subplot(rows, columns, number)
        _lines(axes, _counted(film), colour=RED, width=2.0)
        _lines(axes, _rows(film[DEFAULT]["tracks"]))
        label(axes, title, "to the left [m]", "ahead [m]")
    return figure


def draw_world(films: Mapping[str, Film]) -> Figure:
    """Draw tracks in the world, and the path and headings of the robot."""
    (film,) = films.values()
    figure, axes = single(3.4)
    robot = np.array(film["robot"])
    axes.plot(robot[:, 0], robot[:, 1], "--", color=RED, linewidth=1.2, label="robot")
    x, y, heading = robot[:: max(len(robot) // 20, 1)].T
    axes.quiver(x, y, np.cos(heading), np.sin(heading), color=BLUE, width=0.003, scale=40.0)
    frame, track, ahead, left = _rows(film[DEFAULT]["tracks"]).T
    x, y, heading = robot[frame.astype(int) - 1].T
    cosine, sine = np.cos(heading), np.sin(heading)
    places = (x + cosine * ahead - sine * left, y + sine * ahead + cosine * left)
    _lines(axes, np.stack([frame, track, *places], axis=1), as_plan=False)
    label(axes, "", "x [m]", "y [m]", is_plan=True, legend=7)
    return figure


def draw_people(films: Mapping[str, Film]) -> Figure:
    """Draw mean and deviation of each person's errors, sideways and ahead."""
    names, means, spreads = [], [], []
    for title, film in films.items():
        hits = hit_rows(film[DEFAULT])
        off = np.abs(hits[:, [6, 5]])
        for person in np.unique(hits[:, 1]):
            own = off[(hits[:, 1] == person) & np.isfinite(off).all(axis=1)]
            if len(own):
                names.append(f"{title.split()[-1]},{person:.0f}")
                means.append(own.mean(axis=0))
                spreads.append(own.std(axis=0))
    figure, axes = single(3.2)
    at = np.arange(len(names))
    for column, (name, colour) in enumerate((_AXES[6], _AXES[5])):
        mean, spread = ([one[column] for one in values] for values in (means, spreads))
        style: dict[str, Any] = {"color": colour, "label": name, "error_kw": {"linewidth": 0.7}}
        axes.bar(at + 0.4 * column - 0.2, mean, 0.38, yerr=spread, **style)
    axes.set_xticks(at, names, rotation=90)
    axes.set_ylim(bottom=0.0)
    label(
        axes, "", "set, person", "error [m]", legend=7, ncols=2, loc="lower left", bbox_to_anchor=(0.0, 1.0)
    )
    return figure


def draw_errors(films: Mapping[str, Film]) -> Figure:
    """Draw the distance of a drive's first person over time, and the errors sideways and ahead."""
    (film,) = films.values()
    hits = hit_rows(film[DEFAULT])
    hits = hits[hits[:, 1] == hits[:, 1].min()]
    truth = np.array(film["truth"]).reshape(-1, 7)
    truth = truth[truth[:, 1] == hits[0, 1]]
    figure = canvas(4.0)
    above, below = figure.subplots(2, 1, sharex=True)
    above.plot(truth[:, 0], truth[:, 4], color=RED, linewidth=1.2)
    label(above, "", "", "distance [m]")
    for column in (6, 5):
        name, colour = _AXES[column]
        below.plot(hits[:, 0], hits[:, column], color=colour, linewidth=0.9, label=name)
    below.axhline(0.0, color="#999999", linewidth=0.6)
    label(below, "", "image", "error [m]", legend=7)
    return figure


def draw_crossing(films: Mapping[str, Film]) -> Figure:
    """Draw true paths, and tracks without and with depth in the filters."""
    (film,) = films.values()
    paths = {
        "true": _counted(film),
        "filters without depth": _rows(film[NO_DEPTH]["tracks"]),
        "filters with depth": _rows(film[FILTERS]["tracks"]),
    }
    figure = canvas(3.2)
    for axes, (title, rows) in zip(
        figure.subplots(1, 3, sharex=True, sharey=True), paths.items(), strict=True
    ):
        _lines(axes, rows)
        label(axes, title, "to the left [m]", "ahead [m]" if title == "true" else "")
    return figure


_FIGURES: Final[Mapping[str, Callable[[Mapping[str, Film]], Figure]]] = {
    "paths": draw_paths,
    "world": draw_world,
    "people": draw_people,
    "errors": draw_errors,
    "crossing": draw_crossing,
}
"""Figures of drives, by their name in declarations."""


def draw_legs(using: Measurement) -> Figure:
    """Draw a person's path relative to the robot, and the distance over time: true, by depth, by legs."""
    film, figure = legs_run(using), canvas(3.6)
    left, right = figure.subplots(1, 2)
    for name, rows, colour, size in (
        ("true", _counted(film), BLUE, 2.4),
        ("depth and colour", _rows(film["depth"]), "#2e7d32", 1.2),
        ("legs", _rows(film["legs"]), RED, 1.2),
    ):
        left.plot(rows[:, 3], rows[:, 2], ".", markersize=size, color=colour, label=name)
        right.plot(rows[:, 0], np.hypot(rows[:, 2], rows[:, 3]), ".", markersize=size, color=colour)
    left.invert_xaxis()
    label(left, "", "to the left [m]", "ahead [m]", legend=7, markerscale=4)
    label(right, "", "image", "from the robot [m]")
    return figure


def _rows(tracks: Sequence[Sequence[float]]) -> Floats:
    """Return frame, track and position (N, 4)."""
    return np.array(tracks).reshape(-1, 4)


def _counted(film: Film) -> Floats:
    """Return frame, person and position (N, 4) of all counted people."""
    truth = np.array(film["truth"], dtype=np.float64).reshape(-1, 7)
    return np.asarray(truth[truth[:, 6] > 0.0][:, :4])


def _lines(
    axes: Axes, rows: Floats, colour: str | None = None, width: float = 1.0, *, as_plan: bool = True
) -> None:
    """Draw the path of each id from rows (N, 4), frame, id, x, y; on a plan x is up and y to the left."""
    for number, identity in enumerate(np.unique(rows[:, 1])):
        own = rows[rows[:, 1] == identity]
        for part in (own[frames] for frames in unbroken(own[:, 0], _GAP)):
            x, y = (part[:, 3], part[:, 2]) if as_plan else (part[:, 2], part[:, 3])
            axes.plot(x, y, color=colour or _IDS(number % 10), linewidth=width)
    if as_plan and not axes.xaxis_inverted():
        axes.invert_xaxis()


@dataclass(frozen=True, slots=True, eq=False)
class LearnedFilm:
    """A learned person, and later images of the same person.

    Attributes:
        moment: the moment of learning.
        person: ground truth at that moment.
        later: further images.
    """

    moment: Moment
    person: PersonTruth
    later: Sequence[Moment]

    @property
    def box(self) -> Box:
        """The learned box."""
        assert self.person.box is not None  # the person can be learned
        return self.person.box

    def learned(self, config: AttentionConfig) -> tuple[ImageSums, PersonModel]:
        """Learn the person; return the learned appearance with the image that was used."""
        sight = ImageSums.of(self.moment.frame.rgb(COLOUR), config)
        return sight, learn(sight, self.box, config)


def learned_films(scenario: str = FOCUS_SCENE, seed: int = 1, every: int = 15) -> Iterator[LearnedFilm]:
    """Return each person of a clip with the first image that shows most of it."""
    loaded = load_scenario(scenario)
    moments = list(play_focus(loaded, seed, every))
    for number in sorted({one.id for moment in moments for one in wanted(loaded, moment.truth)}):
        for k, moment in enumerate(moments):
            person = next((one for one in moment.truth.people if one.id == number), None)
            if person is not None and can_be_learned(person, moment.frame.rgb(COLOUR).shape):
                yield LearnedFilm(moment, person, moments[k + 1 :])
                break


def draw_excitation() -> Figure:
    """Draw excitation and inhibition of a torso, and their difference: figure 5.6."""
    first = next(learned_films())
    sight, look = first.learned(PRINTED)
    known = dict(look.parts)[TORSO]
    assert sight.maps is not None
    page = canvas(1.7)
    image, *axes = page.subplots(1, 4)
    _show_colour(image, first.moment, "image, and the learned box")
    frame_box(image, first.box, PINK, linewidth=1.3)
    excited, inhibited = (sight.maps @ one.astype(np.float32) for one in (known.excites, known.inhibits))
    maps = (excited, inhibited, attention_map(sight, known, PRINTED))
    _show_maps(axes, maps, ("a) excitation E", "b) inhibition I", "c) A = E - I, above 0"))
    return page


def draw_part_scores() -> Figure:
    """Draw the scores of torso, head and patterns, and of the whole person: figure 5.7."""
    first = next(learned_films())
    page = canvas(2.9)
    variants = ((PRINTED, "as printed"), (_ALONE, "default"))
    for (image, *row), (config, name) in zip(page.subplots(2, 5), variants, strict=True):
        focus = search(*first.learned(config), config)
        head, torso = focus.parts
        _show_colour(image, first.moment, name)
        for part in (HEAD, TORSO):
            frame_box(image, _part_box(part, first.box), PINK, linewidth=1.3)
        maps = (torso.features, head.features, torso.patterns, focus.scores)
        _show_maps(row, maps, ("torso", "face", "patterns", "person"))
    return page


def draw_focus_paths() -> Figure:
    """Draw the path of the focus for each of three people, from image to image: figure 5.8."""
    films = list(learned_films(every=5))
    page = canvas(4.2)
    for (above, below), film in zip(page.subplots(2, len(films)).T, films, strict=True):
        sight, look = film.learned(_ALONE)
        _show_maps([above], [search(sight, look, _ALONE).scores], [f"score, {film.person.name}"])
        _show_colour(below, film.later[-1], "path of the focus")
        places = [
            search(ImageSums.of(one.frame.rgb(COLOUR), _ALONE), look, _ALONE).place for one in film.later
        ]
        below.plot(*np.array(places).T, "-", color=GREEN, linewidth=1.0)
        below.plot(*places[-1], "+", color=PINK, markersize=9, markeredgewidth=1.8)
    return page


def draw_examples() -> Figure:
    """Draw all maps of a few images, and the resulting focus: figure 5.9."""
    film, config = next(iter(learned_films("follow_passers_by", 0, 60))), AttentionConfig()
    _, look = film.learned(config)
    shown = film.later[1:11:2]
    page = canvas(7.0)
    for (image, *column), moment in zip(page.subplots(5, len(shown)).T, shown, strict=True):
        focus = search(ImageSums.of(moment.frame.rgb(COLOUR), config), look, config)
        head, torso = focus.parts
        maps = (head.features, torso.features, torso.patterns, focus.scores)
        _show_maps(column, maps, ("face", "torso", "patterns", "person"))
        _show_colour(image, moment, f"{moment.frame.time_s:.0f} s, score {focus.score:.2f}")
        frame_box(image, focus.box, GREEN, linewidth=1.3)
    return page


def _part_box(part: ModelPart, box: Box) -> Box:
    left, top, width, height = box
    wide = part.width * height
    return left + (width - wide) / 2.0, top + part.top * height, wide, part.height * height


def _show_colour(axes: Axes, moment: Moment, title: str) -> None:
    show_image(axes, moment.frame.rgb(COLOUR), title, interpolation="nearest")


def _show_maps(row: Sequence[Axes], maps: Sequence[NDArray[np.number] | None], names: Sequence[str]) -> None:
    for axes, scores, name in zip(row, maps, names, strict=True):
        assert scores is not None
        # Scores outside the image are 0, and high scores may differ little: the scale starts above 0.
        lowest = np.percentile(scores[scores > 0], 1.0) if (scores > 0).any() else None
        show_image(axes, scores, name, cmap="inferno", interpolation="nearest", vmin=lowest)


def scene_maps(using: Measurement) -> Figure | None:
    """Draw ground truth and models' backgrounds for a sequence of each kind (figures 3.8 to 3.13).

    None if a plan omits all of them.
    """
    names = [name for name in using.plan.scenes if name in SHOWN]
    runs = using.results(Unit.of(watch_scene, name, 0, TOF) for name in names)
    if not runs:
        return None
    figure = canvas(1.45 * len(runs))
    colours = colormaps["viridis_r"].with_extremes(bad="#000000")
    grid = figure.subplots(len(runs), len(_SHOWN), squeeze=False)
    for row, title, run in zip(grid, names, runs, strict=True):
        for axes, name in zip(row, _SHOWN, strict=True):
            depth = read_map(run["maps"][name])
            shown = np.ma.masked_equal(depth, 0.0)
            axes.imshow(shown, cmap=colours, vmin=_NEAREST_M, vmax=_FARTHEST_M, interpolation="nearest")
            axes.set_xticks([])
            axes.set_yticks([])
        row[0].set_ylabel(title, fontsize=8)
    for axes, words in zip(grid[0], _SHOWN.values(), strict=True):
        axes.set_title(words, fontsize=8)
    return figure
