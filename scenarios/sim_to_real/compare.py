"""Compare rendered clips with real ones."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.scores.bootstrap import Interval, bootstrap
from peopleboy.scenarios.sim_to_real.clips import (
    SIDE,
    Clip,
    ClipFrame,
    Grey,
    background_patches,
    find_clips,
    person_patches,
    random_patches,
)
from peopleboy.scenarios.sim_to_real.measures import ImageStatistics, gradient, measure_images
from peopleboy.tracker.sensors.depth.human_windows import hog_descriptor

# A classifier two-sample test: how well a small classifier separates rendered patches from real ones.

Floats = NDArray[np.float64]

FEWEST: Final = 24
"""Minimum number of patches per side."""

_FOLDS: Final = 5
_REPEATS: Final = 4
_STRENGTH: Final = 0.01  # C of the logistic regression: 332 features, some hundreds of patches
_GRADIENTS: Final = np.array([0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, np.inf])


@dataclass(frozen=True, slots=True)
class Separability:
    """How well a classifier separates rendered patches from real ones.

    Attributes:
        auc: area under the ROC curve, 0.5 for inseparable patches, 1 for perfect separation: mean over folds,
            and its 95 % bootstrap interval over folds.
        folds: area under the ROC curve of each fold.
        scenes: numbers of rendered and real scenes.
        patches: numbers of rendered and real patches.
    """

    auc: Interval
    folds: tuple[float, ...]
    scenes: tuple[int, int]
    patches: tuple[int, int]


def features(patch: Grey) -> Floats:
    """Return the features of a patch (32, 32), gradients only: HOG (324,) and a histogram of magnitudes (8,).

    Source: N. Dalal and B. Triggs, Histograms of oriented gradients for human detection, CVPR 2005: cells of
    8 x 8 pixels, blocks of 2 x 2 cells, 9 orientations.
    """
    hog = np.asarray(hog_descriptor((SIDE, SIDE)).compute(patch), np.float64).ravel()
    steps = np.histogram(gradient(patch), _GRADIENTS)[0] / patch.size
    return np.concatenate([hog, np.sqrt(steps)])


def classify_patches(
    rendered: Sequence[Sequence[Grey]], real: Sequence[Sequence[Grey]], seed: int, of_what: str
) -> Separability:
    """Train a logistic regression, and test it on held-out scenes.

    The scenes of both sides are divided into folds four times. The number of folds is the number of scenes of
    the smaller side, at most five. No scene is in training and test of the same fold.

    Args:
        rendered: patches of each rendered scene.
        real: patches of each real scene.
        seed: seed of the division into folds.
        of_what: name of the patches, for errors.

    Raises:
        BadInput: scikit-learn is missing, or there are too few scenes or patches.
    """
    try:
        from sklearn.linear_model import LogisticRegression
        from sklearn.metrics import roc_auc_score
        from sklearn.pipeline import make_pipeline
        from sklearn.preprocessing import StandardScaler
    except ImportError as error:
        raise BadInput("sim-to-real needs scikit-learn: pip install scikit-learn") from error
    sides = [[_table(scene) for scene in side if len(scene)] for side in (rendered, real)]
    for name, side in zip(("rendered", "real"), sides, strict=True):
        _check_enough(name, side, of_what)
    rng = np.random.default_rng([seed, 1998])
    count = min(_FOLDS, *(len(side) for side in sides))
    aucs = []
    for _ in range(_REPEATS):
        dealt = [_deal(len(side), count, rng) for side in sides]
        for fold in range(count):
            train, test = [_gather(sides, dealt, fold, kept) for kept in (False, True)]
            model: Any = make_pipeline(
                StandardScaler(), LogisticRegression(C=_STRENGTH, class_weight="balanced", max_iter=2000)
            )
            model.fit(*train)
            aucs.append(float(roc_auc_score(test[1], model.decision_function(test[0]))))
    return Separability(
        auc=bootstrap(aucs, rng),
        folds=tuple(aucs),
        scenes=(len(sides[0]), len(sides[1])),
        patches=(sum(map(len, sides[0])), sum(map(len, sides[1]))),
    )


def _check_enough(name: str, side: Sequence[Floats], of_what: str) -> None:
    if len(side) < 2:
        raise BadInput(
            f"{of_what}: {len(side)} {name} scene has any; at least 2 are needed, "
            "one for training and one for the test"
        )
    patches = sum(map(len, side))
    if patches < FEWEST:
        raise BadInput(f"{of_what}: only {patches} {name} patches; at least {FEWEST} are needed")


def _table(scene: Sequence[Grey]) -> Floats:
    return np.array([features(patch) for patch in scene])


def _deal(scenes: int, folds: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """Return a fold for every scene, so that each fold has at least one scene."""
    return np.asarray(rng.permutation(np.arange(scenes) % folds))


def _gather(
    sides: Sequence[Sequence[Floats]], dealt: Sequence[NDArray[np.int64]], fold: int, is_test: bool
) -> tuple[Floats, NDArray[np.int64]]:
    """Return the features (N, F) of a fold, or of all others, and whether each is real (N,)."""
    chosen = [
        np.concatenate([rows for rows, own in zip(side, folds, strict=True) if (own == fold) == is_test])
        for side, folds in zip(sides, dealt, strict=True)
    ]
    labels = np.repeat([0, 1], [len(rows) for rows in chosen])
    return np.concatenate(chosen), labels


PICTURES: Final = 40
"""Pictures of each scene, spread evenly."""

_PATCHES: Final = 240  # per scene, and at most as many of people
SHOWN: Final = 24
"""Patches in a grid."""


@dataclass(frozen=True, slots=True, eq=False)
class SceneStatistics:
    """One scene: its name, the numbers of pictures and people, and the statistics of the pictures."""

    name: str
    pictures: int
    people: int
    stats: ImageStatistics


@dataclass(frozen=True, slots=True, eq=False)
class Side:
    """Rendered scenes, or real ones.

    Attributes:
        stats: statistics of all scenes, weighted by their numbers of pictures.
        scenes: statistics of each scene.
        background: patches (32, 32) of background for display.
        people: patches (32, 32) of people for display.
    """

    stats: ImageStatistics
    scenes: tuple[SceneStatistics, ...]
    background: tuple[Grey, ...]
    people: tuple[Grey, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """Comparison of rendered and real scenes.

    Attributes:
        rendered: the rendered scenes.
        real: the real scenes.
        separability: separability of patches from anywhere.
        of_people: separability of people; None if there are too few.
        lacking: why there is no result for people; empty if there is one.
    """

    rendered: Side
    real: Side
    separability: Separability
    of_people: Separability | None
    lacking: str

    def to_json(self) -> dict[str, Any]:
        """Return the comparison for JSON."""
        return {
            "auc": asdict(self.separability),
            "auc_people": None if self.of_people is None else asdict(self.of_people),
            "lacking": self.lacking,
            "rendered": _figures(self.rendered),
            "real": _figures(self.real),
        }


@dataclass(frozen=True, slots=True, eq=False)
class _Cut:
    """Pictures of a scene, and patches from them."""

    name: str
    moments: list[ClipFrame]
    anywhere: list[Grey]
    background: list[Grey]
    people: list[Grey]


def compare_images(rendered: Sequence[Path], real: Sequence[Path], seed: int = 0) -> Comparison:
    """Compare the clips in these folders; the same seed chooses the same patches.

    Args:
        rendered: folders of runs with pictures, or of sets of them.
        real: folders of real clips, or of sets of them.
        seed: 0 or more.

    Raises:
        BadInput: a folder has no pictures or ground truth, pictures are unsuitable, or there are too few
            scenes or patches.
    """
    sides = [_cut(find_clips(folders), seed) for folders in (rendered, real)]
    separability = classify_patches(
        [scene.anywhere for scene in sides[0]], [scene.anywhere for scene in sides[1]], seed, "patches"
    )
    of_people, lacking = None, ""
    try:
        of_people = classify_patches(
            [scene.people for scene in sides[0]], [scene.people for scene in sides[1]], seed, "people"
        )
    except BadInput as error:
        lacking = str(error)
    return Comparison(_side(sides[0], seed), _side(sides[1], seed), separability, of_people, lacking)


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
    people = [patch for moment in moments for patch in person_patches(moment)]
    kept = rng.permutation(len(people))[:_PATCHES]
    return _Cut(
        name=clips[0].name if len(clips) == 1 else Path(clips[0].scene).name,
        moments=moments,
        anywhere=[patch for moment in moments for patch in random_patches(moment, share, rng)],
        background=[patch for moment in moments for patch in background_patches(moment, 1, rng)],
        people=[people[index] for index in sorted(kept)],
    )


def _side(scenes: Sequence[_Cut], seed: int) -> Side:
    rng = np.random.default_rng([seed, 64])
    return Side(
        stats=measure_images([moment for scene in scenes for moment in scene.moments], rng),
        scenes=tuple(
            SceneStatistics(
                scene.name, len(scene.moments), len(scene.people), measure_images(scene.moments, rng)
            )
            for scene in scenes
        ),
        background=_in_turn([scene.background for scene in scenes], rng),
        people=_in_turn([scene.people for scene in scenes], rng),
    )


def _in_turn(scenes: Sequence[Sequence[Grey]], rng: np.random.Generator) -> tuple[Grey, ...]:
    """Choose patches for display, one of every scene in turn."""
    mixed = [[scene[index] for index in rng.permutation(len(scene))] for scene in scenes]
    longest = max((len(scene) for scene in mixed), default=0)
    return tuple(scene[turn] for turn in range(longest) for scene in mixed if turn < len(scene))[:SHOWN]


def _figures(side: Side) -> dict[str, Any]:
    return figures_of(side.stats) | {
        "scenes": {
            scene.name: {"pictures": scene.pictures, "people": scene.people} | figures_of(scene.stats)
            for scene in side.scenes
        }
    }


def figures_of(stats: ImageStatistics) -> dict[str, float | None]:
    """Return the scalar statistics of pictures; None for undefined ones."""
    has_people = bool(len(stats.contrast))
    return {
        "background_deviation": stats.deviation,
        "noise": None if np.isnan(stats.noise) else stats.noise,
        "share_clipped": stats.clipped,
        "contrast_median": float(np.median(stats.contrast)) if has_people else None,
        "contrast_in_ring_median": float(np.median(stats.contrast_in_ring)) if has_people else None,
    }
