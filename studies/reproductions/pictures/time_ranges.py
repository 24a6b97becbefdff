"""When who is in sight: figure 4 of the 2005 paper."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from matplotlib.figure import Figure

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.studies.reproductions.pictures.png import canvas, label
from peopleboy.tracker.frame import THERMAL

SCENE: Final = "hall_visits"
SEED: Final = 0
_COLOUR: Final = "#1f78b4"


def draw_time_ranges() -> Figure:
    """Draw a line for each person over the images in which it is counted and in sight."""
    seen: dict[str, list[int]] = {}
    for number, (world, _) in enumerate(blind_drive(load_scenario(SCENE), SEED), 1):
        for person in world.truth(THERMAL).people:
            if person.is_counted and person.visible_px > 0:
                seen.setdefault(person.name, []).append(number)
    return _drawn(seen)


def _drawn(seen: Mapping[str, Sequence[int]]) -> Figure:
    page = canvas(0.8 + 0.18 * len(seen))
    axes = page.subplots()
    for row, frames in enumerate(seen.values(), 1):
        spans = [(start, end + 1 - start) for start, end in stretches(frames)]
        axes.broken_barh(spans, (row - 0.35, 0.7), color=_COLOUR)
    axes.set_yticks(range(1, len(seen) + 1), list(seen))
    label(axes, "", "image")
    return page


def stretches(frames: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Give first and last of each unbroken run of ascending numbers."""
    start = last = None
    for frame in frames:
        if start is None or last is None or frame > last + 1:
            if start is not None and last is not None:
                yield start, last
            start = frame
        last = frame
    if start is not None and last is not None:
        yield start, last
