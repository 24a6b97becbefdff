"""What happened to things, in words."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from peopleboy.tracker.scene_model.scene import Change, Happening

_DONE: Final = {Change.APPEARED: "put down", Change.VANISHED: "took away", Change.MOVED: "moved"}
_ALONE: Final = {Change.APPEARED: "appeared", Change.VANISHED: "vanished", Change.MOVED: "moved"}


def sentence(
    happening: Happening,
    person_name: Callable[[int | None], str | None] = lambda number: None,  # noqa: ARG005
    thing_name: str | None = None,
) -> str:
    """Say what happened, such as "6.0 s: person 1 moved object 2 by 1.1 m"; by names where they are known."""
    thing = thing_name or f"object {happening.object}"
    way = f" by {happening.way_m:.1f} m" if happening.change is Change.MOVED else ""
    start = f"{happening.time_s:.1f} s: "
    if happening.person is None:
        return f"{start}{thing} {_ALONE[happening.change]}{way}"
    who = person_name(happening.person) or f"person {happening.person}"
    return f"{start}{who} {_DONE[happening.change]} {thing}{way}"
