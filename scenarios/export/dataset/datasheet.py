"""The README of a rendered set, under the questions of a datasheet.

The questions are those of Gebru et al., "Datasheets for Datasets", 2021.
"""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import jinja2

from peopleboy.scenarios.export.dataset.checks import Check
from peopleboy.scenarios.export.dataset.statistics import Bin, Statistics
from peopleboy.scenarios.export.image_words import describe_images
from peopleboy.scenarios.files.equip_robot import equip_robot
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.random_worlds.distribution import ODDS, RANGES, SHARES
from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.cameras.kinds import KINDS, image_folders, kind_of

_TEMPLATE = Path(__file__).parent / "datasheet.md.jinja"


def write_datasheet(
    path: Path,
    statistics: Mapping[str, Statistics],
    checks: Sequence[Check],
    about: Mapping[str, Any],
    scenarios: Sequence[Scenario],
) -> None:
    """Write the datasheet of a set.

    Args:
        path: the file.
        statistics: of all, and of each split that has runs.
        checks: what was looked at.
        about: words of the command that ask for it, images, tracker, versions, size_mb, which splits are
            lacking, and of random worlds histograms of what was drawn.
        scenarios: what was played.
    """
    environment = jinja2.Environment(trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined)
    environment.filters |= {"span": _span, "quote": shlex.quote}
    template = environment.from_string(_TEMPLATE.read_text(encoding="utf-8"))
    outfits = [equip_robot(scenario.spec.robot).cameras for scenario in scenarios]
    text = template.render(
        statistics=statistics,
        checks=checks,
        about=about,
        scenarios=scenarios,
        ranges=RANGES,
        shares=SHARES,
        odds=ODDS,
        images=describe_images(outfits),
        units=_units(outfits),
        folders=_folders(outfits),
    )
    path.write_text(text, encoding="utf-8")


def _folders(outfits: Iterable[Mapping[str, CameraConfig]]) -> dict[str, str]:
    """Say what is in each folder of images, which may be one thing in one scenario and another in another."""
    found: dict[str, dict[str, None]] = {}
    for folder, _, layer in (images for outfit in outfits for images in image_folders(outfit)):
        found.setdefault(folder, {})[layer.what] = None
    return {folder: "; or ".join(whats) for folder, whats in found.items()}


def _units(outfits: Iterable[Mapping[str, CameraConfig]]) -> dict[str, str]:
    """Name the unit of each camera's images; one that a tracker had mounted has the name of its kind."""
    usual = {name: kind.unit for name, kind in KINDS.items()}
    return usual | {name: kind_of(config).unit for outfit in outfits for name, config in outfit.items()}


def _span(one: Bin) -> str:
    return f"{one.start:g} and more" if one.end == float("inf") else f"{one.start:g} to {one.end:g}"
