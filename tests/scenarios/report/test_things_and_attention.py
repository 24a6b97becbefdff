"""Who moved what when, and where attention would look, as a page shows it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cv2
import numpy as np
import pytest

from peopleboy.scenarios.loop.run_events import LogLine
from peopleboy.scenarios.report.charts.timeline_rows import thing_rows
from peopleboy.scenarios.report.charts.timelines import draw_things
from peopleboy.scenarios.report.pictures import attention_strip
from peopleboy.sim.cameras.camera_config import ColourConfig
from peopleboy.sim.truth.events import Move
from peopleboy.tracker.frame import COLOUR
from tests.helpers.runs.hand_made_tracks import track

RED, WALL = (200, 40, 40), (120, 125, 130)
BOX = (100.0, 60.0, 60.0, 150.0)


def line(time_s: float, kind: str, who: str, other: str = "", move: Move | None = None) -> LogLine:
    return LogLine(frame=round(15 * time_s) + 1, time_s=time_s, kind=kind, who=who, other=other, move=move)


def carried(from_s: float, to_s: float) -> Move:
    there = {"from_m": (4.0, 0.0, 0.0), "to_m": (5.0, 0.0, 0.0), "distance_m": 1.0, "turned_deg": 0.0}
    return Move(from_s=from_s, to_s=to_s, **there)  # type: ignore[arg-type]


def found(events: Sequence[LogLine], **more: Any) -> Any:
    run = SimpleNamespace(events=tuple(events), frames=300, rate_hz=15, time_s=lambda k: (k - 1) / 15, **more)
    return SimpleNamespace(run=run)


def test_a_thing_stands_until_somebody_has_it_and_again_afterwards() -> None:
    events = [
        line(5.0, "thing moved", "bear_1", "anna", carried(3.0, 4.5)),
        line(9.0, "thing moved", "bear_1", "", carried(8.0, 9.0)),
    ]
    (row,) = thing_rows(found(events))
    assert [(start, end, look.text) for start, end, look in row.bars] == [
        (0.0, 3.0, ""), (3.0, 4.5, "Anna"), (4.5, 8.0, ""), (8.0, 9.0, "no person"), (9.0, 20.0, ""),
    ]  # fmt: skip
    assert row.bars[1][2].words == "moved 1.00 m by Anna"


def test_what_appears_was_not_there_before_and_what_vanishes_is_not_there_after() -> None:
    events = [
        line(2.0, "thing appeared", "bag", "ben"),
        line(6.0, "thing vanished", "can", "ben"),
        line(8.0, "thing vanished", "bag", "ben"),
    ]
    bag, can = thing_rows(found(events))
    assert [(start, end) for start, end, _ in bag.bars] == [(2.0, 8.0)]
    assert [(start, end) for start, end, _ in can.bars] == [(0.0, 6.0)]
    assert bag.marks[0] == (2.0, "2.0 s: appeared, by Ben")


def test_a_run_in_which_nothing_happens_to_things_has_no_such_timeline() -> None:
    assert draw_things(found([line(1.0, "lost", "track 1")]), "run") == ""
    drawn = draw_things(found([line(5.0, "thing moved", "bear_1", "anna", carried(3.0, 4.5))]), "run")
    assert drawn.count("<svg") == 2


def attentive(folder: Path, tracker: str = "attentive", *, has_images: bool = True) -> Any:
    """Somebody in red stands there, is away from 5 to 15 s, and comes back."""
    rng = np.random.default_rng(0)
    (folder / COLOUR).mkdir()
    for frame in (5, 76, 151, 226) if has_images else ():
        image = np.full((240, 320, 3), WALL, np.uint8) + rng.integers(0, 8, (240, 320, 3), np.uint8)
        if frame != 151:
            left, top, width, height = (int(edge) for edge in BOX)
            image[top : top + height, left : left + width] = RED
        cv2.imwrite(str(folder / COLOUR / f"{frame:06d}.png"), image[..., ::-1])
    events = [line(5.0, "lost", "track 1"), line(15.0, "re-identified", "track 1")]
    about, robot = SimpleNamespace(tracker=tracker), SimpleNamespace(cameras={COLOUR: ColourConfig()})
    view = found(events, about=about, robot=robot, folder=folder)
    tracks = {frame: [track(1, boxes={COLOUR: BOX})] for frame in range(1, 76)}
    view.files = SimpleNamespace(tracks_by_frame=lambda: tracks)
    return view


def test_attention_is_shown_when_its_person_is_learned_lost_away_and_found(tmp_path: Path) -> None:
    pictures = attention_strip(attentive(tmp_path))
    assert [picture.caption.split(":")[0].replace("\xa0", " ") for picture in pictures] == [
        "0.3 s, learned", "5.0 s, lost", "10.0 s, away", "15.0 s, found again",
    ]  # fmt: skip
    scores = [float(picture.caption.rpartition(" ")[2]) for picture in pictures]
    assert scores[2] < 0.5 * min(scores[0], scores[3])


@pytest.mark.parametrize(("tracker", "has_images"), [("contour", True), ("attentive", False)])
def test_other_trackers_and_runs_without_images_have_no_attention_to_show(
    tmp_path: Path, tracker: str, has_images: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("peopleboy.scenarios.report.pictures.find_spec", lambda name: None)  # noqa: ARG005
    assert attention_strip(attentive(tmp_path, tracker, has_images=has_images)) == []
