"""What tracks get wrong, and what the metrics say of it: figure 3.4 of the thesis on people tracking."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from peopleboy.studies.reproductions.pictures.png import canvas, label
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


def _true(frame: NDArray[np.int64], number: NDArray[np.int64], boxes: NDArray[np.float64]) -> TrueBoxes:
    return TrueBoxes(
        frame=frame, id=number, box=boxes, counted=np.ones(len(boxes), np.bool_), visible=np.ones(len(boxes))
    )
