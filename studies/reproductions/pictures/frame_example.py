"""One frame and what the metrics say of it: figure 3.5 of the thesis on people tracking."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from peopleboy.studies.reproductions.pictures.png import canvas, label
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes

_TARGET, _CANDIDATE, _SHARED = "#1a1a1a", "#d95f02", "#b5bcc6"


@dataclass(frozen=True, slots=True, eq=False)
class Example:
    """One frame.

    Attributes:
        targets, candidates: (T, 4) and (C, 4) [px] left, top, width, height.
        matches: which target and candidate belong together, of those that overlap by more than half.
    """

    targets: NDArray[np.float64]
    candidates: NDArray[np.float64]
    matches: tuple[tuple[int, int], ...]


EXAMPLE: Final = Example(
    targets=np.array([(30.0, 50.0, 50.0, 160.0), (140.0, 60.0, 44.0, 140.0), (240.0, 70.0, 40.0, 120.0)]),
    candidates=np.array([(36.0, 58.0, 50.0, 160.0), (144.0, 50.0, 50.0, 140.0), (262.0, 96.0, 40.0, 120.0)]),
    matches=((0, 0), (1, 1)),
)
"""Two are found, and the third candidate overlaps the third person by less than half."""


def score_example() -> Scores:
    """Score the one frame of figure 3.5."""
    return evaluate(_seen(EXAMPLE.targets), _said(EXAMPLE.candidates), frames=1)


def draw_example() -> Figure:
    """Draw targets, candidates, what they share where they are associated, and the metrics: figure 3.5."""
    page = canvas(3.0)
    axes, text = page.subplots(1, 2, width_ratios=(2, 1))
    for boxes, colour, style in ((EXAMPLE.targets, _TARGET, "-"), (EXAMPLE.candidates, _CANDIDATE, "--")):
        for left, top, width, height in boxes.tolist():
            axes.add_patch(
                Rectangle((left, top), width, height, fill=False, edgecolor=colour, linestyle=style)
            )
    for target, candidate in EXAMPLE.matches:
        left, top, width, height = shared(EXAMPLE.targets[target], EXAMPLE.candidates[candidate])
        axes.add_patch(
            Rectangle((left, top), width, height, fill=False, hatch="///", edgecolor=_SHARED, linewidth=0)
        )
    axes.set(xlim=(0, 320), ylim=(240, 0), aspect="equal")
    label(axes, "targets: solid; candidates: dashed; counted: hatched", "column [px]", "row [px]")
    thesis, paper = score_example().thesis, score_example().paper
    lines = [f"{name.upper()} {getattr(thesis, name):.1f}" for name in ("cr", "cp", "ca", "ar", "ap", "aa")]
    lines += [f"{name.upper()} {getattr(paper, name):.1f}" for name in ("oar", "bap", "adc")]
    text.text(
        0.1, 0.95, "\n".join(["thesis [%]", *lines[:6], "", "paper [%]", *lines[6:]]), va="top", fontsize=9
    )
    text.axis("off")
    return page


def shared(one: NDArray[np.float64], other: NDArray[np.float64]) -> tuple[float, float, float, float]:
    """Give the box (left, top, width, height) that two overlapping boxes (4,) share."""
    corner = np.maximum(one[:2], other[:2])
    size = np.minimum(one[:2] + one[2:], other[:2] + other[2:]) - corner
    return float(corner[0]), float(corner[1]), float(size[0]), float(size[1])


def _seen(boxes: NDArray[np.float64]) -> TrueBoxes:
    count = len(boxes)
    return TrueBoxes(
        frame=np.ones(count, np.int64),
        id=np.arange(1, count + 1),
        box=boxes,
        counted=np.ones(count, np.bool_),
        visible=np.ones(count),
    )


def _said(boxes: NDArray[np.float64]) -> TrackBoxes:
    count = len(boxes)
    return TrackBoxes(
        frame=np.ones(count, np.int64), id=np.arange(1, count + 1), box=boxes, confidence=np.ones(count)
    )
