"""Ablation from the thesis to the best contour tracker: `python -m benchmarks.tracker_ablation`.

Runs are recorded once, driven by the best tracker; all variants run on the same images.
"""

from collections.abc import Iterator, Sequence
from dataclasses import fields, is_dataclass, replace
from typing import Any

import click
import numpy as np

from benchmarks import call
from benchmarks.compare import Recording, percents, print_head, print_row, record
from peopleboy.tracker.evaluation.evaluate import Scores, combine
from peopleboy.tracker.reproductions.contour.contour_config import TrackerConfig
from peopleboy.tracker.reproductions.contour.contour_tracker import ContourTracker
from peopleboy.tracker.reproductions.contour.variants import CONTOUR, PAPER, THESIS, THESIS_OCCLUSION
from peopleboy.tracker.track import Track

ONE = ("single_stationary", "single_follow")
SEVERAL = ("crossing_3", "hidden_1s", "hidden_2s", "pass_behind_pillar", "three_depths", "turn_while_hidden")
EMPTY = "empty_room"

# Every setting in which the two differ belongs to one step; a name stands for all settings with that prefix.
# The order is that of `variants`: a step may need earlier ones.
STEPS: dict[str, tuple[str, ...]] = {
    "differences saturate softly at 18 grey instead of being clipped at 40": (
        "contour.saturation_grey",
        "contour.is_cut_off",
        "likelihood.slope",
        "likelihood.threshold",
    ),
    "fewer points, at two distances": (
        "contour.points",
        "contour.reach_px",
        "contour.body_reach",
        "contour.head_reach",
        "contour.inner_depth",
        "contour.side_end_deg",
    ),
    "a further outer point, far from the head": ("contour.far_head_reach",),
    "people's proportions": (
        "detector.limits.ratio",
        "detector.limits.h",
        "detector.limits.y",
        "person.limits",
    ),
    "people stand on the floor": ("detector.limits.y_below_horizon",),
    "a wider margin around hot regions": ("contour.hot_margin_px",),
    "hot regions only where the room is black": ("contour.dark_share",),
    "differences relative to clutter": ("contour.clutter_share",),
    "heads truncated by the image border": ("contour.cut_share",),
    # First, since sharp weights with the thesis's penalties detect the same person repeatedly.
    "stronger repulsion between filters": ("interaction",),
    "sharper weights; the estimate is the mean of samples near the best one": (
        "detector.sharpness",
        "detector.estimate",
        "person.sharpness",
        "person.estimate",
        "person.resamples_core",
    ),
    "half of the detector's samples drawn anew, none of the person's": (
        "detector.fresh_share",
        "person.fresh_share",
        "person.log_uniform_h",
    ),
    "track initiation and deletion take several frames": ("life",),
    "motion scaled by size; odometry": ("motion",),
    "more weight on the weakest section": ("likelihood.weakest_share",),
    "clothes may be colder than the background": ("contour.cold_response",),
    "the line under the feet": ("contour.feet", "contour.unseen_response"),
    "box proportions": ("box",),
    "some samples resized": ("person.resized_share",),
    "smoothing": ("smoothing",),
    "colours and thermal pattern per body part, independent of lighting": ("colour", "appearance"),
    "the person in front is no evidence for the person behind": ("depth",),
    "overlapped people keep their height": ("height",),
    "occluded tracks coast, and are searched for": ("occlusion", "person.floor"),
    "occluded tracks are reported only if certain": ("occlusion.shows_only_sure",),
    "lost people are remembered": ("occlusion.remembers_lost",),
    "the detector scans each image twice": ("search.scans",),
    "large isolated people are confirmed sooner, small ones later": ("search",),
}
COLUMNS = (
    "one: CP",
    "CR",
    "AA",
    "several: CP",
    "CR",
    "AA",
    "IDF1",
    "HOTA",
    "switches",
    "empty: false per 100 frames",
)


def differing(one: Any, other: Any, path: str = "") -> Iterator[str]:
    """Yield the settings, such as "contour.points", in which two configurations differ.

    A record of a different class is yielded itself, followed by its differences from that class's defaults.
    """
    for item in fields(other):
        name = f"{path}{item.name}"
        mine, theirs = getattr(one, item.name), getattr(other, item.name)
        if is_dataclass(mine) and is_dataclass(theirs):
            if type(mine) is not type(theirs):
                yield name
            yield from differing(_of_kind(mine, theirs), theirs, f"{name}.")
        elif mine != theirs:
            yield name


def _of_kind(record: Any, model: Any) -> Any:
    """Return a record if it has the model's class, else the defaults of that class."""
    return record if type(record) is type(model) else type(model)()


def step_of(setting: str) -> str:
    """Return the step of a setting: the one with the longest matching prefix."""
    return max(
        (len(start), step) for step, starts in STEPS.items() for start in starts if setting.startswith(start)
    )[1]


def adopt(base: Any, source: Any, names: Sequence[str]) -> Any:
    """Copy the named settings of `source` to `base`."""
    changes: dict[str, Any] = {}
    for head in dict.fromkeys(name.split(".")[0] for name in names):
        rest = [name.split(".", 1)[1] for name in names if name.startswith(f"{head}.")]
        mine, theirs = getattr(base, head), getattr(source, head)
        if is_dataclass(mine) and is_dataclass(theirs):
            mine = _of_kind(mine, theirs) if head in names else mine
            theirs = adopt(mine, _of_kind(theirs, mine), rest)
        changes[head] = theirs
    return replace(base, **changes)


def variants() -> Iterator[tuple[str, TrackerConfig]]:
    """Return the sources' trackers, then the steps added one by one, then the best without each step."""
    yield "paper, literal", PAPER
    yield "thesis, literal, with colour and occlusions", THESIS_OCCLUSION
    yield "thesis, literal, thermal alone", THESIS
    settings = list(differing(THESIS, CONTOUR))
    own = {step: [name for name in settings if step_of(name) == step] for step in STEPS}
    config = THESIS
    for step, names in own.items():
        config = adopt(config, CONTOUR, names)
        yield f"+ {step}", config
    for step, names in own.items():
        yield f"without: {step}", adopt(CONTOUR, THESIS, names)


def score(runs: dict[str, list[Recording]], config: TrackerConfig) -> list[str]:
    """Return the metrics of a row, in the order of `COLUMNS`; false alarms are per 100 frames."""
    one, several, nobody = (scores_of(runs, names, config) for names in (ONE, SEVERAL, (EMPTY,)))
    cells = percents(one, "CP", "CR", "AA") + percents(several, "CP", "CR", "AA", "IDF1", "HOTA")
    cells = ["-" if cell == "nan" else cell for cell in cells]
    false = 100 * nobody.counts.candidates / nobody.counts.frames
    return [*cells, f"{several.mot.clear.switches}", f"{false:.1f}"]


def scores_of(runs: dict[str, list[Recording]], names: Sequence[str], config: TrackerConfig) -> Scores:
    """Score a tracker on all runs of several scenarios together."""
    numbered = [(seed, run) for name in names for seed, run in enumerate(runs[name])]
    return combine([run.score(_tracked(run, config, seed)) for seed, run in numbered])


def _tracked(run: Recording, config: TrackerConfig, seed: int) -> Iterator[tuple[Track, ...]]:
    tracker = ContourTracker(config, np.random.default_rng(seed))
    return (tracker.update(frame) for frame in run.frames)


@click.command()
@click.option("--seeds", default=2, show_default=True, help="Runs per scenario.")
def main(seeds: int) -> None:
    """Print metrics [%] for each step from the literal to the best contour tracker, as a Markdown table."""
    runs = {name: [record(name, seed) for seed in range(seeds)] for name in (*ONE, *SEVERAL, EMPTY)}
    print_head("", COLUMNS)
    for name, config in variants():
        print_row(name, score(runs, config))


if __name__ == "__main__":
    call(main, "benchmarks.tracker_ablation")
