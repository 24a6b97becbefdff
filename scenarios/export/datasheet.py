"""Measure a rendered set, and write its README, structured by the questions of a datasheet.

The questions are those of Gebru et al., "Datasheets for Datasets", 2021.
"""

import json
import shlex
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import cv2
import jinja2
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from peopleboy.scenarios.export.dataset_checks import Check
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.random_worlds.distribution import Distribution
from peopleboy.scenarios.run_folder.finished_run import cameras_of
from peopleboy.scenarios.run_folder.image_files import describe_images
from peopleboy.scenarios.run_folder.run_tables import LOCAL, is_in_image
from peopleboy.scenarios.scores.suite_table import add_up, count
from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.cameras.kinds import KINDS, image_folders, kind_of

VISIBLE_EDGES = (0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0)
DISTANCE_EDGES_M = (0.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, np.inf)
_AS_STORED = cv2.IMREAD_COLOR | cv2.IMREAD_ANYDEPTH
_EVERY = 15  # every how many images one is used for the means


@dataclass(frozen=True, slots=True)
class Bin:
    """One bar of a histogram: the number of boxes between two edges."""

    start: float
    end: float
    boxes: int


@dataclass(frozen=True, slots=True)
class Statistics:
    """Statistics of a set, or of a split.

    Attributes:
        runs: number of runs.
        content: counts as in the thesis's table 3.1 (`peopleboy.scenarios.scores.suite_table.Content`).
        visible: people whose silhouette reaches into the image, by visible fraction.
        distance: the same people, by distance from the camera [m].
        height_px: 5, 25, 50, 75 and 95 % percentiles of the heights of their boxes [px].
        hidden_mostly_by: number of boxes by their main occluder: person, thing, border; and of boxes of which
            nothing is hidden.
        image_mean, image_sd: by channel [grey], of depth [mm], of every 15th image; empty without images.
    """

    runs: int
    content: dict[str, int]
    visible: tuple[Bin, ...]
    distance: tuple[Bin, ...]
    height_px: tuple[float, ...]
    hidden_mostly_by: dict[str, int]
    image_mean: dict[str, list[float]]
    image_sd: dict[str, list[float]]

    def to_json(self) -> dict[str, Any]:
        """Return the statistics for JSON; the last bin of distances has no end."""
        data = asdict(self)
        for each in (*data["visible"], *data["distance"]):
            each["end"] = None if np.isinf(each["end"]) else each["end"]
        return data


def measure(runs: Sequence[Path]) -> Statistics:
    """Go through the truth, and the images if there are any, of these runs' folders."""
    tables = [pq.read_table((run / "truth.parquet").absolute(), filesystem=LOCAL) for run in runs]
    about = [json.loads((run / "run.json").read_text(encoding="utf-8")) for run in runs]
    frames = [(len(one.get("kept_frames", range(one["frames"]))), one["rate_hz"]) for one in about]
    people = pa.concat_tables(tables)
    inside = is_in_image(people)
    means, deviations = _image_statistics(runs)
    return Statistics(
        runs=len(runs),
        content=asdict(add_up(count(table, *one) for table, one in zip(tables, frames, strict=True))),
        visible=_histogram(people["visible_fraction"].to_numpy()[inside], VISIBLE_EDGES),
        distance=_histogram(people["distance_m"].to_numpy()[inside], DISTANCE_EDGES_M),
        height_px=_heights(people["height_px"].to_numpy()[inside]),
        hidden_mostly_by=_hiders(people.filter(pa.array(inside))),
        image_mean=means,
        image_sd=deviations,
    )


def _histogram(values: NDArray[np.float64], edges: Sequence[float]) -> tuple[Bin, ...]:
    numbers, _ = np.histogram(values, bins=np.array(edges))
    return tuple(
        Bin(start, end, int(n)) for start, end, n in zip(edges[:-1], edges[1:], numbers, strict=True)
    )


def _heights(heights_px: NDArray[np.float64]) -> tuple[float, ...]:
    if not len(heights_px):
        return ()
    return tuple(float(round(value, 1)) for value in np.quantile(heights_px, (0.05, 0.25, 0.5, 0.75, 0.95)))


def _hiders(people: pa.Table) -> dict[str, int]:
    names = set(people["name"].to_pylist())
    total = {"nothing": 0, "person": 0, "thing": 0, "border": 0}
    for shares in people["hidden_by"].to_pylist():
        worst = max(shares, key=lambda pair: pair[1], default=("", 0.0))
        kind = "person" if worst[0] in names else "border" if worst[0] == "border" else "thing"
        total[kind if worst[1] > 0.0 else "nothing"] += 1
    return total


def _image_statistics(runs: Sequence[Path]) -> tuple[dict[str, list[float]], dict[str, list[float]]]:
    means, deviations = {}, {}
    cameras = {name: camera for run in runs for name, camera in cameras_of(run).items()}
    for name, camera in cameras.items():
        paths = [path for run in runs for path in sorted((run / name).glob("*.png"))[::_EVERY]]
        images = (image for path in paths if (image := cv2.imread(str(path), _AS_STORED)) is not None)
        channels = kind_of(camera).channels
        each = [_moments(image[..., :channels]) for image in images]
        if not each:
            continue
        moments = np.mean(each, axis=0)
        means[name] = [round(float(value), 2) for value in moments[0]]
        spread = np.sqrt(np.maximum(moments[1] - moments[0] ** 2, 0.0))
        deviations[name] = [round(float(value), 2) for value in spread]
    return means, deviations


def _moments(image: NDArray[Any]) -> NDArray[np.float64]:
    """Return mean and mean square (2, channels), channels in the order red, green, blue."""
    flat = np.float64(image.reshape(-1, image.shape[2])[:, ::-1])
    return np.array([flat.mean(axis=0), (flat**2).mean(axis=0)])


_TEMPLATE = Path(__file__).parent / "datasheet.md.jinja"


def write_datasheet(
    path: Path,
    statistics: Mapping[str, Statistics],
    checks: Sequence[Check],
    about: Mapping[str, Any],
    scenarios: Sequence[Scenario],
    distribution: Distribution,
) -> None:
    """Write the datasheet of a set.

    Args:
        path: the file.
        statistics: statistics of all runs, and of each split that has runs.
        checks: results of the checks.
        about: arguments of the command, images, tracker, versions, size_mb, empty splits, and for random
            worlds histograms of the sampled values.
        scenarios: the scenarios of the runs.
        distribution: distribution of the random worlds, if they are random.
    """
    environment = jinja2.Environment(trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined)
    environment.filters |= {"span": _span, "quote": shlex.quote}
    template = environment.from_string(_TEMPLATE.read_text(encoding="utf-8"))
    outfits = [scenario.spec.robot.config().cameras for scenario in scenarios]
    text = template.render(
        statistics=statistics,
        checks=checks,
        about=about,
        scenarios=scenarios,
        shares=distribution.shares,
        odds=distribution.odds,
        images=describe_images(outfits),
        units=_units(outfits),
        folders=_folders(outfits),
    )
    path.write_text(text, encoding="utf-8")


def _folders(outfits: Iterable[Mapping[str, CameraConfig]]) -> dict[str, str]:
    """Describe the content of each folder of images, which may differ between scenarios."""
    found: dict[str, dict[str, None]] = {}
    for folder, _, layer in (images for outfit in outfits for images in image_folders(outfit)):
        found.setdefault(folder, {})[layer.what] = None
    return {folder: "; or ".join(whats) for folder, whats in found.items()}


def _units(outfits: Iterable[Mapping[str, CameraConfig]]) -> dict[str, str]:
    """Return the unit of each camera's images; a camera mounted for a tracker has the name of its kind."""
    usual = {name: kind.unit for name, kind in KINDS.items()}
    return usual | {name: kind_of(config).unit for outfit in outfits for name, config in outfit.items()}


def _span(one: Bin) -> str:
    return f"{one.start:g} and more" if one.end == float("inf") else f"{one.start:g} to {one.end:g}"
