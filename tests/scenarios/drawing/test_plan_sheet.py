from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from peopleboy.scenarios.drawing.draw_plan import draw_plan
from peopleboy.scenarios.drawing.plan_paths import draw_person
from peopleboy.scenarios.drawing.plan_sheet import MARGIN_M, Labels, lay_out, sections
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.people.person_config import PersonConfig, Reaction, Waypoint


@given(st.floats(2.0, 100.0), st.floats(2.0, 20.0))
def test_sections_are_equal_overlap_and_cover_the_place(length: float, width: float) -> None:
    pieces = sections((0.0, 0.0, length, width))
    assert pieces[0][0] == pytest.approx(-MARGIN_M)
    assert pieces[-1][2] == pytest.approx(length + MARGIN_M)
    assert all(before[2] > after[0] for before, after in pairwise(pieces))
    assert max(p[2] - p[0] for p in pieces) == pytest.approx(min(p[2] - p[0] for p in pieces))


def test_a_room_stays_whole_and_a_long_corridor_is_cut() -> None:
    assert len(sections((0.0, 0.0, 10.0, 8.0))) == 1
    assert len(sections((0.0, 0.0, 54.0, 3.4))) > 2


def test_all_sections_have_one_scale() -> None:
    figure = Figure()
    FigureCanvasAgg(figure)
    for axes in lay_out(figure, sections((0.0, 0.0, 54.0, 3.4)), 11.0, head_in=0.8, foot_in=1.0):
        extent, (low, high), (bottom, top) = axes.get_window_extent(), axes.get_xlim(), axes.get_ylim()
        assert extent.width / (high - low) == pytest.approx(extent.height / (top - bottom))


def test_nothing_is_written_of_what_lies_outside_a_section() -> None:
    figure = Figure()
    FigureCanvasAgg(figure)
    first, *_ = lay_out(figure, sections((0.0, 0.0, 54.0, 3.4)), 11.0, head_in=0.8, foot_in=1.0)
    count = len(first.texts)
    labels = Labels(first)
    labels.write(50.0, 1.0, "far away")
    labels.write(2.0, 1.0, "here")
    assert [text.get_text() for text in first.texts[count:]] == ["here"]


@pytest.mark.thorough
def test_the_plan_of_a_long_corridor_is_no_strip(tmp_path: Path) -> None:
    draw_plan(load_scenario("corridor_patrol"), 0, tmp_path / "plan.png")
    with Image.open(tmp_path / "plan.png") as picture:
        assert picture.height > 0.7 * picture.width


def test_who_leaves_is_said_to_whether_walking_standing_or_there(monkeypatch: pytest.MonkeyPatch) -> None:
    written: list[str] = []
    monkeypatch.setattr(Labels, "write", lambda self, x, y, text, **style: written.append(text))  # noqa: ARG005
    figure = Figure()
    labels = Labels(figure.add_subplot())
    stands = PersonConfig(name="anna", path=(Waypoint(at_m=(3.0, 0.0)),), enter_s=2.0, leave_s=6.0)
    way = (Waypoint(at_m=(3.0, 0.0)), Waypoint(at_m=(5.0, 0.0), speed_m_s=1.0))
    for person in (
        stands,
        replace(stands, enter_s=0.0),
        replace(stands, path=way, leave_s=9.0),
        replace(stands, path=way, leave_s=None),
        replace(stands, leave_s=None),
    ):
        draw_person(figure.axes[0], labels, person, 10.0, "#000000")
    tall = f"anna {stands.height_m:.2f} m"
    assert written == [
        f"{tall}, from 2.0 until 6.0 s",
        f"{tall}, until 6.0 s",
        f"{tall}, from 2.0 s",
        "stays from 5 s, leaves at 9 s",
        f"{tall}, from 2.0 s",
        "stays from 5 s",
        f"{tall}, from 2.0 s",
    ]


def test_the_plan_says_who_yields_reacts_and_waits_for_the_robot() -> None:
    figure = Figure()
    FigureCanvasAgg(figure)
    (axes,) = lay_out(figure, sections((0.0, 0.0, 10.0, 8.0)), 11.0, head_in=0.8, foot_in=1.0)
    path = (
        Waypoint(at_m=(2.0, 2.0)),
        Waypoint(at_m=(6.0, 2.0), until_robot_within_m=1.5, waits_at_most_s=9.0),
    )
    reacts = Reaction(way="makes_way", from_m=3.0)
    draw_person(
        axes, Labels(axes), PersonConfig(name="eve", path=path, yields=True, reacts=reacts), 20.0, "b"
    )
    written = [text.get_text() for text in axes.texts]
    assert "yields, robot: makes way from 3 m" in written
    assert "waits for the robot within 1.5 m,\nat most 9 s more" in written
