"""Folders of small made-up runs: two people side by side, and tracks that lie where a test wants them."""

from __future__ import annotations

import atexit
import json
import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import mkdtemp
from typing import Any
from uuid import uuid4

from peopleboy.scenarios.drawing.contact_sheet import ContactSheet
from peopleboy.scenarios.files.scenario_file import FaultSpec
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.loop.run_events import RunEvents
from peopleboy.scenarios.run_folder.folder import RunFolder
from peopleboy.scenarios.scores.run_scores import score_run
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.truth.truth import PersonTruth
from tests.helpers.runs import synthetic_ticks as made

ANNA, BEN, NOWHERE = (60.0, 50.0, 40.0, 170.0), (220.0, 50.0, 40.0, 170.0), (140.0, 20.0, 20.0, 60.0)
FRAMES = 90

Boxes = Mapping[int, tuple[float, float, float, float]]  # of tracks, by number
Hidden = Callable[[int], float]  # share of ben that anna hides, by frame; more than 1: he is behind the robot


def steady(frame: int) -> Boxes:  # noqa: ARG001
    """Everybody has one number."""
    return {1: ANNA, 2: BEN}


def never(frame: int) -> float:  # noqa: ARG001
    """Nobody hides anybody."""
    return 0.0


def swapped(frame: int) -> Boxes:
    """The two numbers change places at frame 46."""
    return {1: ANNA, 2: BEN} if frame < 46 else {1: BEN, 2: ANNA}


def renumbered(frame: int) -> Boxes:
    """Ben is lost at frame 40 and found as number 3 at frame 61; number 4 lies on nobody from 70 to 79."""
    boxes = {1: ANNA}
    if frame < 40:
        boxes[2] = BEN
    if frame > 60:
        boxes[3] = BEN
    if 70 <= frame < 80:
        boxes[4] = NOWHERE
    return boxes


def hidden_from_40_to_60(frame: int) -> float:
    """Ben is wholly hidden in between."""
    return 1.0 if 40 <= frame < 60 else 0.0


def away_and_back(frame: int) -> Boxes:
    """Ben has number 2 up to frame 35, and number 5 from 71 on."""
    return {1: ANNA} | ({2: BEN} if frame < 35 else {5: BEN} if frame > 70 else {})


def known_late(frame: int) -> Boxes:
    """The same, but he has number 5 for seven frames only, and then 2 again."""
    return {1: ANNA} | ({2: BEN} if frame < 35 or frame > 77 else {5: BEN} if frame > 70 else {})


def passed_on(frame: int) -> Boxes:
    """Anna's number is gone from frame 40 on, and on Ben, who had none, from 46 on."""
    return {1: ANNA} if frame < 40 else {1: BEN} if frame >= 46 else {}


def swapped_for_a_moment(frame: int) -> Boxes:
    """The two numbers change places at frame 46, and back at 56."""
    return swapped(frame) if frame < 56 else steady(frame)


def again_on_nobody(frame: int) -> Boxes:
    """Ben's number is gone from frame 30 to 39, and then lies on nobody."""
    return {1: ANNA} | ({2: BEN} if frame < 30 else {2: NOWHERE} if frame >= 40 else {})


def again_for_a_moment(frame: int) -> Boxes:
    """Ben's number is gone from frame 30 to 39, on him for three frames, and then gone for good."""
    return {1: ANNA} | (
        {2: BEN} if frame < 30 or 40 <= frame < 43 else {2: NOWHERE} if 43 <= frame < 60 else {}
    )


def flickering(frame: int) -> Boxes:
    """Ben's number is away from 30 to 31 and from 50 to 59; number 9 lies on nobody at 70 and 71."""
    is_away = 30 <= frame < 32 or 50 <= frame < 60
    return {1: ANNA} | ({} if is_away else {2: BEN}) | ({9: NOWHERE} if frame in (70, 71) else {})


def until_75(frame: int) -> Boxes:
    """Ben has number 2 up to frame 74."""
    return {1: ANNA, 2: BEN} if frame < 75 else {1: ANNA}


def hidden_from_75(frame: int) -> float:
    """Ben is wholly hidden from then on, but for the last two frames."""
    return 0.0 if frame < 75 else 1.0 if frame < FRAMES - 1 else 0.5


def blinking(frame: int) -> float:
    """Ben is hidden every other half a second."""
    return 0.5 if frame // 8 % 2 else 0.0


def behind_from_35_to_70(frame: int) -> float:
    """Ben is behind the robot in between."""
    return 2.0 if 35 <= frame <= 70 else 0.0


def write_run(
    folder: Path,
    boxes: Callable[[int], Boxes] = steady,
    hidden: Hidden = never,
    scenario: Mapping[str, Any] | None = None,
    faults: Sequence[FaultSpec] = (),
    **about: Any,
) -> Path:
    """Write a complete run and return its folder; `about` goes into run.json."""
    known = {
        "scenario": "toy",
        "seed": 0,
        "tracker": "detection",
        "renderer": "raycast",
        "rate_hz": 15,
    } | about
    played = {"name": "toy", "description": "Two people stand."} if scenario is None else dict(scenario)
    shutil.copytree(_written(boxes, hidden, json.dumps(played), json.dumps(known), tuple(faults)), folder)
    return folder


@cache
def _written(
    boxes: Callable[[int], Boxes], hidden: Hidden, played: str, known: str, faults: tuple[FaultSpec, ...]
) -> Path:
    """Write a run once, which is a picture of a dozen tiles; most tests want one that another had, too."""
    folder = _made() / str(uuid4())
    events, sheet = RunEvents(faults), ContactSheet("toy")
    folder.mkdir()
    with RunFolder(folder, json.loads(played), json.loads(known), RobotConfig().cameras, frames=False) as run:
        for frame in range(1, FRAMES + 1):
            tick = _tick(frame, boxes(frame), hidden(frame))
            lines = events.update(tick)
            sheet.add(tick, lines)
            run.write(tick, [line.to_json() for line in lines])
        run.flush()
        sheet.save(folder / "contact_sheet.png")
        run.complete(score_run(folder, FRAMES, None).to_json())
    return folder


@cache
def _made() -> Path:
    folder = Path(mkdtemp(prefix="toy_runs_"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def _tick(frame: int, boxes: Boxes, hidden: float) -> Tick:
    tick = made.make_tick(frame)
    ben = _at(made.person(2, "ben", 6.0, min(hidden, 1.0)), BEN)
    if hidden > 1.0:
        ben = replace(
            ben, box=None, whole_box=None, visible_box=None, whole_px=0, visible_fraction=0.0, hidden_by={}
        )
    people = (_at(made.person(1, "anna", 4.0), ANNA), ben)
    tracks = tuple(replace(made.with_box(box), id=number) for number, box in boxes.items())
    ellipses = {number: replace(made.ELLIPSE, x=box[0] + box[2] / 2.0) for number, box in boxes.items()}
    explanation = replace(made.explain(tracks), ellipses=ellipses)
    truth = replace(tick.truth, people=people)
    return replace(tick, truths={"thermal": truth, "colour": truth}, tracks=tracks, explanation=explanation)


def _at(person: PersonTruth, box: tuple[float, float, float, float]) -> PersonTruth:
    return replace(person, box=box, whole_box=box, visible_box=box)
