"""How attention finds a person: figures 5.6 to 5.9 of the thesis on situation awareness."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.truth.truth import PersonTruth
from peopleboy.studies.reproductions.attention.watch_focus import (
    FocusMoment,
    can_be_learned,
    play_focus,
    wanted,
)
from peopleboy.studies.reproductions.pictures.png import canvas, label
from peopleboy.tracker.attention.attend import PersonLook, attention_map, learn, search
from peopleboy.tracker.attention.attention_config import PRINTED, AttentionConfig
from peopleboy.tracker.attention.parts import HEAD, TORSO, Part
from peopleboy.tracker.attention.sight import Sight
from peopleboy.tracker.track import Box

SCENE: Final = "crossing_3"
SEED: Final = 1
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


def learned_films(scenario: str = SCENE, seed: int = SEED, every: int = 15) -> Iterator[LearnedFilm]:
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


def draw_parts() -> Figure:
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


def draw_paths() -> Figure:
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


def _place(moment: FocusMoment, look: PersonLook) -> tuple[float, float]:
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
