"""What tracks get wrong, and what metrics say of it: figures 3.4 and 3.5 of the thesis on people tracking."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from peopleboy.scenarios.studies.reproduce.pictures.png import canvas, label
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes

_FRAMES: Final = 60
_FIRST, _SECOND = 1, 2  # who walks to the right, and who to the left
_BOX: Final = (40.0, 130.0)  # width and height [px]
_TOP: Final = 60.0
_OFF_PX: Final = (2.0, 4.0)  # by how much every candidate is off
_TRUE: Final = "#b5bcc6"
_COLOURS: Final = ("#1f78b4", "#d95f02", "#1b9e77", "#7570b3", "#e7298a")


@dataclass(frozen=True, slots=True)
class Claimed:
    """What a tracker says in one frame: on whom a candidate lies, and by which number it goes."""

    frame: int
    person: int
    id: int


def _correct(frame: int) -> list[Claimed]:
    return [Claimed(frame, person, person) for person in (_FIRST, _SECOND)]


def _scattered(frame: int) -> list[Claimed]:
    """Lose whoever walks to the right for a while, twice, and find somebody new each time."""
    part = frame // 20
    pieces = [Claimed(frame, _FIRST, 10 + part)] if frame % 20 < 15 else []
    return [*pieces, Claimed(frame, _SECOND, _SECOND)]


def _swapped(frame: int) -> list[Claimed]:
    is_after = frame >= _FRAMES // 2
    ids = (_SECOND, _FIRST) if is_after else (_FIRST, _SECOND)
    return [Claimed(frame, _FIRST, ids[0]), Claimed(frame, _SECOND, ids[1])]


def _fetched(frame: int) -> list[Claimed]:
    """Let both candidates lie on whoever walks to the right, once the two have met."""
    other = _FIRST if frame >= _FRAMES // 2 else _SECOND
    return [Claimed(frame, _FIRST, _FIRST), Claimed(frame, other, _SECOND)]


ERRORS: Final[Mapping[str, Callable[[int], list[Claimed]]]] = {
    "a) correct": _correct,
    "b) scattering": _scattered,
    "c) swapping": _swapped,
    "d) fetching": _fetched,
}
"""What is claimed in each frame, by the kind of error."""


def score_error(name: str) -> Scores:
    """Score the claims of one kind of error about two people who cross."""
    return evaluate(_true_walks(), _tracks(name), frames=_FRAMES)


def draw_errors() -> Figure:
    """Draw true walks and tracks over time, with what the metrics make of each error: figure 3.4."""
    page = canvas(4.6)
    for axes, name in zip(page.subplots(2, 2, sharex=True, sharey=True).flat, ERRORS, strict=True):
        _draw_walks(axes, name)
    return page


def _draw_walks(axes: Axes, name: str) -> None:
    truth, tracks, scores = _true_walks(), _tracks(name), score_error(name)
    for person in (_FIRST, _SECOND):
        walk = truth.take(truth.id == person)
        axes.plot(walk.frame, _middle(walk.box), color=_TRUE, linewidth=7, solid_capstyle="butt")
    for colour, number in zip(_COLOURS, np.unique(tracks.id).tolist(), strict=False):
        rows = tracks.take(tracks.id == number)
        where = np.full(_FRAMES + 1, np.nan)
        where[rows.frame] = _middle(rows.box)
        axes.plot(where, color=colour, linewidth=1.6)
    thesis, paper, mot = scores.thesis, scores.paper, scores.mot
    told = (
        f"CR {thesis.cr:.0f}  CP {thesis.cp:.0f}  AA {thesis.aa:.0f} | OC {paper.oc:.0f}  ADC {paper.adc:.0f}"
        f" | IDF1 {mot.identity.idf1:.0f}"
    )
    label(axes, f"{name}\n{told}", "frame", "column [px]")


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
    for boxes, colour, style in ((EXAMPLE.targets, "#1a1a1a", "-"), (EXAMPLE.candidates, _COLOURS[1], "--")):
        for left, top, width, height in boxes.tolist():
            axes.add_patch(
                Rectangle((left, top), width, height, fill=False, edgecolor=colour, linestyle=style)
            )
    for target, candidate in EXAMPLE.matches:
        left, top, width, height = shared(EXAMPLE.targets[target], EXAMPLE.candidates[candidate])
        axes.add_patch(
            Rectangle((left, top), width, height, fill=False, hatch="///", edgecolor=_TRUE, linewidth=0)
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


def _middle(box: NDArray[np.float64]) -> NDArray[np.float64]:
    middle: NDArray[np.float64] = box[:, 0] + box[:, 2] / 2.0
    return middle


def _place(frame: int, person: int) -> tuple[float, float, float, float]:
    """Give the true box of somebody who crosses the image within all frames."""
    way = 200.0 * frame / (_FRAMES - 1)
    return (40.0 + way if person == _FIRST else 240.0 - way, _TOP, *_BOX)


def _true_walks() -> TrueBoxes:
    walks = [(frame, person) for frame in range(_FRAMES) for person in (_FIRST, _SECOND)]
    boxes = np.array([_place(frame, person) for frame, person in walks])
    return _true(np.array([frame + 1 for frame, _ in walks]), np.array([one for _, one in walks]), boxes)


def _tracks(name: str) -> TrackBoxes:
    claims = [claim for frame in range(_FRAMES) for claim in ERRORS[name](frame)]
    boxes = np.array([_place(claim.frame, claim.person) for claim in claims])
    boxes[:, :2] += _OFF_PX
    return TrackBoxes(
        frame=np.array([claim.frame + 1 for claim in claims]),
        id=np.array([claim.id for claim in claims]),
        box=boxes,
        confidence=np.ones(len(claims)),
    )


def _seen(boxes: NDArray[np.float64]) -> TrueBoxes:
    return _true(np.ones(len(boxes), np.int64), np.arange(1, len(boxes) + 1), boxes)


def _true(frame: NDArray[np.int64], number: NDArray[np.int64], boxes: NDArray[np.float64]) -> TrueBoxes:
    return TrueBoxes(
        frame=frame, id=number, box=boxes, counted=np.ones(len(boxes), np.bool_), visible=np.ones(len(boxes))
    )


def _said(boxes: NDArray[np.float64]) -> TrackBoxes:
    count = len(boxes)
    return TrackBoxes(
        frame=np.ones(count, np.int64), id=np.arange(1, count + 1), box=boxes, confidence=np.ones(count)
    )
