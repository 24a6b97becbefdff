"""How strongly filters keep each other off: figure 5.3 of the thesis on people tracking."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.sim.random_streams import stream
from peopleboy.studies.reproductions.pictures.png import canvas, label
from peopleboy.tracker.frame import THERMAL as CAMERA
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.thermal.contour.outline import outline
from peopleboy.tracker.thermal.ellipse import Ellipse
from peopleboy.tracker.thermal.people_tracker import PeopleTracker
from peopleboy.tracker.thermal.variants import THESIS
from peopleboy.tracker.track import Box

SCENE: Final = "leader_swap"
SEED: Final = 100
PENALTIES: Final = (10.0, 1.0)
_STREAMS: Final = 6  # random streams of the tracker, all drawn
_BEFORE: Final = 12  # images from where both are made known to where they are drawn
_HIDDEN: Final = 0.2  # share of somebody that is hidden where they are drawn
_COLOURS: Final = ("#ffb000", "#00b3ff")


@dataclass(frozen=True, slots=True, eq=False)
class Meeting:
    """The images in which two people come to overlap.

    Attributes:
        frames: thermal images with their times, the last of which is drawn.
        boxes: of the two [px] in the first two of these images.
        apart_px: between the middles of their true boxes in the last.
    """

    frames: Sequence[Frame]
    boxes: tuple[Box, Box]
    apart_px: float


def draw_interaction() -> Figure:
    """Draw where several random streams end up with a strong and with a weak penalty, on the same image."""
    meeting = find_meeting()
    page = canvas(3.0)
    for axes, penalty in zip(page.subplots(1, 2), PENALTIES, strict=True):
        _draw_contours(axes, meeting, penalty)
    return page


def find_meeting() -> Meeting:
    """Play the film until somebody is hidden by a fifth by somebody else, and keep what precedes it.

    Raises:
        RuntimeError: nobody comes to hide anybody.
    """
    frames: list[Frame] = []
    boxes: list[dict[str, Box]] = []
    for world, seen in blind_drive(load_scenario(SCENE), SEED):
        people = world.truth(CAMERA).people
        frames.append(Frame(images={CAMERA: seen.images[CAMERA]}, time_s=seen.time_s))
        boxes.append({one.name: one.box for one in people if one.box is not None})
        pair = [one.name for one in people if one.name in boxes[-1]]
        start = len(frames) - 1 - _BEFORE
        if start < 0 or not any(one.occluded_fraction > _HIDDEN for one in people):
            continue
        if len(pair) == 2 and pair[0] in boxes[start] and pair[1] in boxes[start + 1]:
            left, right = (boxes[-1][name] for name in pair)
            apart_px = abs(left[0] + left[2] / 2.0 - right[0] - right[2] / 2.0)
            return Meeting(frames[start:], (boxes[start][pair[0]], boxes[start + 1][pair[1]]), apart_px)
    raise RuntimeError(f"nobody hides anybody in {SCENE}")


def contours_after(meeting: Meeting, penalty: float, number: int) -> list[Ellipse]:
    """Let a random stream of the literal tracker follow the two, and give the contours that it ends with."""
    config = replace(THESIS, interaction=replace(THESIS.interaction, penalty=penalty))
    tracker = PeopleTracker(config, stream(number, "reproduce.interaction"))
    for box, frame in zip((*meeting.boxes, *[None] * len(meeting.frames)), meeting.frames, strict=False):
        if box is not None:
            tracker.introduce(box)
        tracker.update(frame)
    return list(tracker.explanation.ellipses.values())


def _draw_contours(axes: Axes, meeting: Meeting, penalty: float) -> None:
    axes.imshow(meeting.frames[-1].grey(CAMERA), cmap="gray", vmin=0, vmax=255)
    gaps = []
    for number in range(_STREAMS):
        contours = contours_after(meeting, penalty, number)
        gaps += [abs(contours[0].x - contours[1].x)] if len(contours) > 1 else []
        for colour, ellipse in zip(_COLOURS, contours, strict=False):
            for line in outline(ellipse):
                axes.plot(*line.T, color=colour, linewidth=0.9)
    axes.set(xticks=[], yticks=[])
    apart = f"{np.mean(gaps):.0f} px apart; truth {meeting.apart_px:.0f} px" if gaps else "none keeps both"
    label(axes, f"rho = {penalty:g}: {apart}; {len(gaps)} of {_STREAMS} keep both")
