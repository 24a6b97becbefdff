"""Train the detector's trees: a soft cascade with hard-negative mining, and the box regression."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from peopleboy.bad_input import BadInput
from peopleboy.studies.training.detector.boosting import Binned, Boosting
from peopleboy.studies.training.detector.evaluation import calibrate, evaluate_trees
from peopleboy.studies.training.detector.mining import (
    detected_windows,
    false_positives,
    patch_pool,
    windows_anywhere,
    windows_with_people,
)
from peopleboy.studies.training.detector.world_sequences import ThermalImage, load_images, render_task
from peopleboy.studies.training.detector.worlds import KINDS, seeds_of
from peopleboy.studies.training.samples import Split, Tasks
from peopleboy.studies.training.specification import Specification, report
from peopleboy.tracker.sensors.thermal.detector.box_regression import BoxRegression
from peopleboy.tracker.sensors.thermal.detector.cascade import Cascade
from peopleboy.tracker.sensors.thermal.detector.patches import Patches, Sums, integrate_windows
from peopleboy.tracker.sensors.thermal.detector.people_trees import (
    FILE,
    PeopleModel,
    PeopleTrees,
    shipped_people_trees,
)
from peopleboy.tracker.sensors.thermal.detector.window import WindowKind

Windows = NDArray[np.float16]
Floats = NDArray[np.float32]

VALIDATION: Final = 30
"""Number of worlds for evaluating the trees: those of the first seeds."""

ROUNDS: Final = {
    WindowKind.WHOLE: (
        Boosting(64, 0.3, features=200),
        Boosting(160, 0.2, features=300),
        Boosting(320, 0.15, features=300),
        Boosting(640, 0.12, features=300),
        Boosting(1500, 0.1),
    ),
    WindowKind.CUT: (
        Boosting(64, 0.3, features=200),
        Boosting(160, 0.2, features=300),
        Boosting(320, 0.15, features=300),
        Boosting(500, 0.1, features=300),
    ),
}
"""Training rounds. After each but the last, false positives are mined as negatives of the next round."""
REGRESSION: Final = Boosting(trees=160, rate=0.1, features=300)

_SEED_OF_PEOPLE: Final = 0
_SEED_OF_BOXES: Final = 1
_SEED_OF_NEGATIVES: Final = 100
_HELD_BACK: Final = 10  # one in so many worlds is held out
_MINED: Final = 16000  # a round
_NEGATIVES: Final = 80000  # in memory, 3.6 kB each
_FIRST_NEGATIVES: Final = 16000

_WEAKEST: Final = 0.03  # share of people, those with the lowest scores, that the thresholds may reject
_REJECTED: Final = 0.005  # share of all other people that may be rejected
# Thresholds are stricter than that, since most windows that they reject have low final scores. The first
# trees separate people from negatives less well.
_STRICTER: Final = np.float32(0.7)
_AFTER: Final = np.float32(32.0)  # trees after which the full margin applies
_SAMPLED: Final = 20000  # windows of people for setting thresholds
_LAST: Final = -4.0
"""Lowest score of a detection, before calibration."""
_LINEAR_FROM: Final = 0.9  # quantile of errors from which on the loss of the box regression is linear (Huber)


@dataclass(frozen=True, slots=True, kw_only=True)
class CascadeTraining(Specification[Tasks]):
    """The cascade is trained on random worlds.

    Some of the worlds are crowded, have no details, or are as warm as people. A tenth of the worlds is held
    out for the calibration of scores.
    """

    sequences: Annotated[
        int, Field(ge=5, le=2000, alias="seeds", description="Number of random worlds to train on.")
    ] = 600
    windows: Annotated[
        tuple[WindowKind, ...],
        Field(
            description="Trees to train: those for people mostly inside the image (whole), or those for "
            "people truncated by its border (cut). The other trees stay unchanged."
        ),
    ] = tuple(WindowKind)
    only_boxes: Annotated[
        bool,
        Field(description="Train only the box regression; the trees that score windows stay unchanged."),
    ] = False

    def default_folder(self, model: str) -> Path:  # noqa: ARG002
        """Return the folder that all models of the detector share."""
        return Path("runs/detector")

    def tasks(self, out: Path) -> Tasks:
        """Render the worlds."""
        seeds = seeds_of(self.sequences), range(VALIDATION)
        return Split(*([render_task(out / "sequences", seed) for seed in part] for part in seeds))

    def fit(self, data: Tasks) -> Mapping[str, PeopleModel]:
        """Train the trees of the chosen kinds."""
        held = data.training[_HELD_BACK - 1 :: _HELD_BACK] or data.training[-1:]
        images = load_images(one.path for one in data.training if one not in held)
        others, shipped = load_images(one.path for one in held), shipped_people_trees()
        trees = {
            kind: with_boxes(images, shipped.trees[kind].cascade, kind)
            if self.only_boxes
            else fit_trees(images, others, kind)
            for kind in WindowKind
            if kind in self.windows
        }
        counts = ((len(kind.seeds(self.sequences)), kind) for kind in KINDS)
        drawn = ", ".join(f"{count} {kind.description} from seed {kind.first_seed}" for count, kind in counts)
        parts = ("boxes of {} people",) if self.only_boxes else ("{} people", "boxes of {} people")
        drawn += f"; {len(held)} of them held out"
        about = {part.format(kind): drawn for part in parts for kind in trees}
        before = shipped if self.only_boxes or len(trees) < len(WindowKind) else PeopleModel({})
        return {FILE: PeopleModel({**before.trees, **trees}, {**before.about, **about})}

    def evaluate(self, model: PeopleModel, data: Tasks) -> Mapping[str, str]:
        """Evaluate detections in the validation worlds."""
        images = load_images(task.path for task in data.validation)
        return {
            f"on worlds 0 to {VALIDATION - 1}, {mount}": str(evaluate_trees(model, images, knows_mount=knows))
            for mount, knows in (("mount known", True), ("mount unknown", False))
        }


def fit_trees(
    images: Sequence[ThermalImage], others: Sequence[ThermalImage], kind: WindowKind
) -> PeopleTrees:
    """Train trees in rounds, each with the false positives of the previous round.

    Args:
        images: training images.
        others: images of held-back worlds, for calibrating scores.
        kind: kind of windows.

    Raises:
        BadInput: scikit-learn is missing, or there are too few people.
    """
    people = windows_with_people(images, np.random.default_rng(_SEED_OF_PEOPLE), kind)
    rng, patches = np.random.default_rng(_SEED_OF_NEGATIVES), patch_pool()
    negatives = windows_anywhere(images, rng, _FIRST_NEGATIVES, kind)
    report(f"{len(images)} images, {len(people)} windows with {kind} people")
    rounds = ROUNDS[kind]
    for number, boosting in enumerate(rounds, 1):
        cascade = fit_cascade(people, negatives, patches, boosting)
        if number < len(rounds):
            mined = false_positives(images, cascade, rng, _MINED, kind)
            report(f"round {number} of {len(rounds)}: {len(negatives)} negatives, {len(mined)} mined")
            negatives = np.concatenate([negatives, mined])
            if len(negatives) > _NEGATIVES:
                negatives = negatives[rng.permutation(len(negatives))[:_NEGATIVES]]
    trees = with_boxes(images, cascade, kind)
    return trees._replace(cascade=cascade.calibrated(*calibrate(kind, trees, others)))


def with_boxes(images: Sequence[ThermalImage], cascade: Cascade, kind: WindowKind) -> PeopleTrees:
    """Train the box regression on the windows that a cascade detects.

    Windows that fit people exactly are not enough: many detected windows are too small or too large, and the
    regression must correct them.
    """
    windows, offsets = detected_windows(images, cascade, np.random.default_rng(_SEED_OF_BOXES), kind)
    report(f"{len(windows)} windows detected as {kind} people")
    return PeopleTrees(cascade, fit_boxes(windows, offsets, cascade.patches))


def fit_cascade(people: Windows, negatives: Windows, patches: Patches, boosting: Boosting) -> Cascade:
    """Train trees on windows (N, 1800) with and without people; both classes have equal total weight.

    Raises:
        BadInput: there are too few windows.
    """
    if min(len(people), len(negatives)) < boosting.smallest:
        raise BadInput(f"{len(people)} windows with people and {len(negatives)} without; use more sequences")
    sums = integrate_windows(np.concatenate([people, negatives]))
    count = sums.shape[1]
    is_person = np.arange(count) < len(people)
    weight = np.where(is_person, 1.0 / len(people), 1.0 / len(negatives)).astype(np.float32)
    weight *= np.float32(count / 2)
    one = np.float32(1.0)

    def loss(outputs: Floats) -> tuple[Floats, Floats]:
        share = one / (one + np.exp(-outputs))
        return weight * (is_person - share), weight * share * (one - share)

    rng = np.random.default_rng(0)
    tables = Binned(patches, sums, rng).boost(loss, boosting, rng)
    some = np.sort(rng.permutation(len(people))[:_SAMPLED])
    accepting = Cascade(patches, *tables, np.full(boosting.trees, -np.inf, np.float32))
    return _with_thresholds(accepting, sums[:, some])


def _with_thresholds(cascade: Cascade, people: Sums) -> Cascade:
    """Set the threshold after each tree so that almost all people with a high final score pass."""
    running = cascade.running(people)
    is_found = running[:, -1] > np.quantile(running[:, -1], _WEAKEST)
    least = np.quantile(running[is_found], _REJECTED, axis=0).astype(np.float32)
    least += _STRICTER * np.minimum(np.arange(len(least), dtype=np.float32) / _AFTER, 1.0)
    least[-1] = _LAST
    return Cascade(cascade.patches, cascade.feature, cascade.threshold, cascade.leaf, least)


def fit_boxes(windows: Windows, offsets: NDArray[np.float64], patches: Patches) -> BoxRegression:
    """Train the box regression on windows (N, 1800) with known offsets (N, 4)."""
    rng = np.random.default_rng(0)
    binned, tables = Binned(patches, integrate_windows(windows), rng), []
    for target in offsets.T.astype(np.float32):
        start = float(np.median(target))
        far = float(np.quantile(np.abs(target - start), _LINEAR_FROM))

        def loss(outputs: Floats, target: Floats = target, far: float = far) -> tuple[Floats, Floats]:
            return np.clip(target - outputs, -far, far), np.ones_like(outputs)

        trees = binned.boost(loss, REGRESSION, rng, start)
        trees.leaf[0] += np.float32(start)
        tables.append(trees)
    return BoxRegression(patches, *(np.stack(column) for column in zip(*tables, strict=True)))
