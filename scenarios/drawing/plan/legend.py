"""What the signs on a plan mean."""

from __future__ import annotations

from typing import Final

from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from peopleboy.scenarios.drawing.plan.moves import COLOUR
from peopleboy.scenarios.drawing.plan.sheet import INK

_PERSON, _ROBOT = "#1f6fb4", "#c0392b"
_TIMES: Final = "Times are those of people whom nobody is in the way of; those who make way are later."


def draw_legend(figure: Figure, side_in: float, *, has_moves: bool) -> None:
    """Write at the foot of a plan what its signs mean; those of moved things where there are any."""
    width, height = figure.get_size_inches()
    figure.legend(
        handles=[*_signs(), *([_ghost()] if has_moves else [])],
        loc="lower left",
        bbox_to_anchor=(side_in / width, 0.24 / height),
        ncols=3,
        fontsize=7.5,
        frameon=False,
        labelcolor=INK,
        borderaxespad=0.0,
        handlelength=2.2,
        columnspacing=1.6,
    )
    figure.text(side_in / width, 0.12 / height, _TIMES, size=7.5, color=INK, va="center")


def _ghost() -> Artist:
    label = "where a thing is moved to, from when on, and by whom"
    return Patch(facecolor="none", edgecolor=COLOUR, ls=(0, (2, 1.5)), label=label)


def _signs() -> list[Artist]:
    def mark(sign: str, label: str, colour: str = _PERSON, **more: object) -> Line2D:
        settings: dict[str, object] = {"marker": sign, "color": colour, "linestyle": "none", "markersize": 6}
        return Line2D([], [], label=label, **(settings | more))  # type: ignore[arg-type]

    return [
        mark("o", "a person's start, name, height, and when they come or go", markeredgecolor="white"),
        mark("o", "where the person is at that time", linestyle="-", markerfacecolor="white", markersize=4),
        mark("s", "end of the way: stays, leaves, or the run ends", markeredgecolor="white", markersize=5),
        mark("o", "a pause on the way", markerfacecolor="none", markersize=9),
        mark(">", "the robot's start", _ROBOT),
        Line2D(
            [], [], color=_ROBOT, ls=(0, (4, 2)), lw=1.4, label="its scripted way; distances of 3 and 10 m"
        ),
        Patch(facecolor=_ROBOT, alpha=0.14, label="what the camera sees at first; darker: people count"),
        Patch(facecolor="none", edgecolor="#d2592f", ls=(0, (3, 2)), label="hangs overhead, or a lintel"),
    ]
