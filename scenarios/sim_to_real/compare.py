"""Set rendered clips beside real ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.sim_to_real.clips import Clip, ClipFrame, Grey, find_clips
from peopleboy.scenarios.sim_to_real.measures import Looks, measure_looks
from peopleboy.scenarios.sim_to_real.patches import anywhere, of_background, of_people
from peopleboy.scenarios.sim_to_real.tell_apart import Told, tell_apart

PICTURES: Final = 40
"""Of each scene, spread evenly."""

_PATCHES: Final = 240  # of a scene, and as many of people at most
SHOWN: Final = 24
"""Patches in a grid."""


@dataclass(frozen=True, slots=True, eq=False)
class SceneLooks:
    """One scene: its name, how many pictures were looked at, and what they are like."""

    name: str
    pictures: int
    people: int
    looks: Looks


@dataclass(frozen=True, slots=True, eq=False)
class Side:
    """Rendered scenes, or real ones.

    Attributes:
        looks: of all scenes together, each counting as many times as it has pictures.
        scenes: each by itself.
        background: patches (32, 32) of background to be shown.
        people: patches (32, 32) of people to be shown.
    """

    looks: Looks
    scenes: tuple[SceneLooks, ...]
    background: tuple[Grey, ...]
    people: tuple[Grey, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """Rendered beside real.

    Attributes:
        rendered: one side.
        real: the other.
        told: how well patches from anywhere are told apart.
        told_people: how well people are; None if there are too few.
        lacking: why there is no figure for people; empty if there is.
    """

    rendered: Side
    real: Side
    told: Told
    told_people: Told | None
    lacking: str

    def to_json(self) -> dict[str, Any]:
        """As JSON can hold it."""
        return {
            "auc": asdict(self.told),
            "auc_people": None if self.told_people is None else asdict(self.told_people),
            "lacking": self.lacking,
            "rendered": _figures(self.rendered),
            "real": _figures(self.real),
        }


@dataclass(frozen=True, slots=True, eq=False)
class _Cut:
    """A scene's pictures, and patches of them."""

    name: str
    moments: list[ClipFrame]
    anywhere: list[Grey]
    background: list[Grey]
    people: list[Grey]


def compare_footage(rendered: Sequence[Path], real: Sequence[Path], seed: int = 0) -> Comparison:
    """Compare the clips in these folders; the same seed chooses the same patches.

    Args:
        rendered: folders of runs with pictures, or of sets of them.
        real: folders of real clips, or of several.
        seed: 0 or more.

    Raises:
        BadInput: a folder without pictures or truth, pictures that cannot be used, too few scenes or patches.
    """
    sides = [_cut(find_clips(folders), seed) for folders in (rendered, real)]
    told = tell_apart(
        [scene.anywhere for scene in sides[0]], [scene.anywhere for scene in sides[1]], seed, "patches"
    )
    told_people, lacking = None, ""
    try:
        told_people = tell_apart(
            [scene.people for scene in sides[0]], [scene.people for scene in sides[1]], seed, "people"
        )
    except BadInput as error:
        lacking = str(error)
    return Comparison(_side(sides[0], seed), _side(sides[1], seed), told, told_people, lacking)


def _cut(clips: Sequence[Clip], seed: int) -> list[_Cut]:
    scenes = dict.fromkeys(clip.scene for clip in clips)
    return [
        _cut_scene([clip for clip in clips if clip.scene == scene], np.random.default_rng([seed, number]))
        for number, scene in enumerate(scenes)
    ]


def _cut_scene(clips: Sequence[Clip], rng: np.random.Generator) -> _Cut:
    each = max(PICTURES // len(clips), 2)
    moments = [moment for clip in clips for moment in clip.moments(each)]
    share = -(-_PATCHES // max(len(moments), 1))
    people = [patch for moment in moments for patch in of_people(moment)]
    kept = rng.permutation(len(people))[:_PATCHES]
    return _Cut(
        name=clips[0].name if len(clips) == 1 else Path(clips[0].scene).name,
        moments=moments,
        anywhere=[patch for moment in moments for patch in anywhere(moment, share, rng)],
        background=[patch for moment in moments for patch in of_background(moment, 1, rng)],
        people=[people[index] for index in sorted(kept)],
    )


def _side(scenes: Sequence[_Cut], seed: int) -> Side:
    rng = np.random.default_rng([seed, 64])
    return Side(
        looks=measure_looks([moment for scene in scenes for moment in scene.moments], rng),
        scenes=tuple(
            SceneLooks(scene.name, len(scene.moments), len(scene.people), measure_looks(scene.moments, rng))
            for scene in scenes
        ),
        background=_in_turn([scene.background for scene in scenes], rng),
        people=_in_turn([scene.people for scene in scenes], rng),
    )


def _in_turn(scenes: Sequence[Sequence[Grey]], rng: np.random.Generator) -> tuple[Grey, ...]:
    """Choose patches to be shown: one of every scene, then another one of every scene."""
    mixed = [[scene[index] for index in rng.permutation(len(scene))] for scene in scenes]
    longest = max((len(scene) for scene in mixed), default=0)
    return tuple(scene[turn] for turn in range(longest) for scene in mixed if turn < len(scene))[:SHOWN]


def _figures(side: Side) -> dict[str, Any]:
    return figures_of(side.looks) | {
        "scenes": {
            scene.name: {"pictures": scene.pictures, "people": scene.people} | figures_of(scene.looks)
            for scene in side.scenes
        }
    }


def figures_of(looks: Looks) -> dict[str, float | None]:
    """The figures of some pictures that are one number each; None where there is none."""
    has_people = bool(len(looks.contrast))
    return {
        "background_deviation": looks.deviation,
        "noise": None if np.isnan(looks.noise) else looks.noise,
        "share_clipped": looks.clipped,
        "contrast_median": float(np.median(looks.contrast)) if has_people else None,
        "contrast_in_ring_median": float(np.median(looks.contrast_in_ring)) if has_people else None,
    }
