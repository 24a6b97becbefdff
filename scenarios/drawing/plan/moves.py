"""What is moved on a plan: where things come to stand, as dashed outlines, and arrows that lead there."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from peopleboy.scenarios.drawing.labels import Labels
from peopleboy.scenarios.drawing.outlines import outlines
from peopleboy.sim.places.moving import ActionKind, Mover, Stance
from peopleboy.sim.places.place import Fixture, Place
from peopleboy.sim.truth.events import STANDS_S

COLOUR = "#8a5a00"
_SHORTEST_M = 0.15
_CLEAR_M = 0.2  # between the middle of an outline and its label


@dataclass(frozen=True, slots=True)
class _Leg:
    """A thing's way from one rest to the next; from None it appears, and to None it vanishes."""

    start: Stance | None
    end: Stance | None
    at_s: float
    by: str | None


def draw_moves(axes: Axes, labels: Labels, place: Place) -> None:
    """Draw where moved things come to stand, the ways there, when they set off, and by whose hand."""
    for mover in place.movers:
        own = [fixture for fixture in place.fixtures if fixture.name.split("/")[0] == mover.name]
        for leg in _legs(mover):
            if leg.end is not None:
                _draw_ghost(axes, own, leg.end)
            _draw_arrow(axes, leg)
            _label(labels, leg)


def _legs(mover: Mover) -> Iterator[_Leg]:
    """The ways of a thing, from rest to rest."""
    here: Stance | None = None if mover.is_hidden_at_start else mover.start
    setting_off: tuple[Stance | None, float, str | None] | None = None
    for index, action in enumerate(mover.actions):
        if setting_off is None:
            setting_off = (here, action.at_s, action.by)
        here = None if action.kind is ActionKind.VANISH else action.target
        follows = mover.actions[index + 1 : index + 2]
        lasts = bool(action.takes_s) and any(
            after.takes_s and after.at_s - action.ends_s < STANDS_S for after in follows
        )
        if not lasts:
            start, at_s, by = setting_off
            yield _Leg(start, here, at_s, by)
            setting_off = None


def _draw_ghost(axes: Axes, fixtures: list[Fixture], stance: Stance) -> None:
    for fixture in fixtures:
        moved = replace(fixture, position=stance.position_m, orientation=stance.orientation)
        for corners in outlines(moved):
            axes.add_patch(
                Polygon(corners, facecolor="none", edgecolor=COLOUR, lw=0.7, ls=(0, (2, 1.5)), zorder=5)
            )


def _draw_arrow(axes: Axes, leg: _Leg) -> None:
    if leg.start is None or leg.end is None:
        return
    tail, head = leg.start.position_m[:2], leg.end.position_m[:2]
    if math.dist(tail, head) > _SHORTEST_M:
        axes.annotate(
            "", head, tail, zorder=6,
            arrowprops={"arrowstyle": "-|>", "color": COLOUR, "lw": 1.1, "shrinkA": 0, "shrinkB": 2},
        )  # fmt: skip


def _label(labels: Labels, leg: _Leg) -> None:
    spot = leg.end if leg.end is not None else leg.start
    assert spot is not None
    what = "vanishes" if leg.end is None else "appears" if leg.start is None else "moved"
    by = "" if leg.by is None else f" by {leg.by}"
    x, y, _ = spot.position_m
    labels.block(x, y, _CLEAR_M)
    labels.write(x, y, f"{what} {leg.at_s:.0f} s{by}", size=6.2, color=COLOUR)
