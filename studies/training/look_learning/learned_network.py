"""What was learned: how well it tells where people are, and its file."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from peopleboy.scenarios.run_folder.atomic_output import atomic, writing_to
from peopleboy.studies.training.look_learning.examples import LookExamples
from peopleboy.tracker.boxes import Floats, iou
from peopleboy.tracker.proposals.looks.closer_look import CloserLook
from peopleboy.tracker.proposals.looks.crops import planes_of
from peopleboy.tracker.proposals.looks.network import CropNetwork
from peopleboy.tracker.proposals.looks.second_look import SecondLook
from peopleboy.tracker.proposals.placing import moved

_AT_ONCE: Final = 256  # crops


def told_of(network: SecondLook | CloserLook, looks: LookExamples) -> Floats:
    """Give what a network tells (N, told) of examples."""
    parts = [
        network.told(planes_of(looks.crops[k : k + _AT_ONCE]), looks.numbers[k : k + _AT_ONCE])
        for k in range(0, len(looks.overlap), _AT_ONCE)
    ]
    return np.concatenate([np.empty((0, network.FORM.told)), *parts])


def mean_overlaps(offsets: Floats, looks: LookExamples, rows: NDArray[np.bool_]) -> tuple[float, float]:
    """Give the mean IoU of some examples as they were and after offsets (N, 4) were told."""
    window = np.tile([0.0, 0.0, 1.0, 1.0], (int(rows.sum()), 1))
    told = iou(moved(window, offsets[rows]), moved(window, looks.offsets[rows].astype(np.float64)))
    return float(looks.overlap[rows].mean()), float(told.mean())


def write_network(network: CropNetwork, path: Path) -> Path:
    """Write a network whole, or not at all.

    Raises:
        BadInput: a path that cannot be used.
    """
    with writing_to(path.parent), atomic(path) as part:
        path.parent.mkdir(parents=True, exist_ok=True)
        network.save(part)
    return path


def say(words: str) -> None:
    """Tell whoever waits how far it is."""
    Console(stderr=True).print(words, highlight=False)
