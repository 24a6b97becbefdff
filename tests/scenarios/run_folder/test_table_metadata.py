"""Parquet files say what their numbers mean."""

from __future__ import annotations

from pathlib import Path

import pyarrow.parquet as pq
import pytest

import peopleboy
from peopleboy.scenarios.run_folder.run_tables import FRAMES, ROBOT, THINGS, TRACKS, TRUTH, write_table


@pytest.mark.parametrize(
    ("column", "unit", "frame"),
    [
        ("x_m", "m", "world"),
        ("velocity_x_m_s", "m/s", "world"),
        ("left_px", "px", "image"),
        ("joints_px", "px", "image"),
        ("joints_m", "m", "world"),
        ("part_temperature_c", "degC", None),
        ("time_s", "s", None),
        ("visible_fraction", None, None),
    ],
)
def test_columns_have_their_unit_and_frame(column: str, unit: str | None, frame: str | None) -> None:
    about = TRUTH.field(column).metadata or {}
    found = [about.get(key, b"").decode() or None for key in (b"unit", b"frame")]
    assert found == [unit, frame]


def test_a_place_is_in_the_frame_of_the_robot_and_a_file_keeps_all_that(tmp_path: Path) -> None:
    write_table(tmp_path / "tracks.parquet", [], TRACKS)
    schema = pq.read_schema(tmp_path / "tracks.parquet")
    assert schema.field("place_xx_m2").metadata == {b"unit": b"m2", b"frame": b"robot"}
    assert schema.metadata[b"peopleboy.table"] == b"tracks"
    assert schema.metadata[b"peopleboy.version"].decode() == peopleboy.__version__
    assert schema.metadata[b"peopleboy.frame.robot"].decode() == FRAMES["robot"]


def test_every_length_speed_and_angle_has_a_unit() -> None:
    for schema in (TRUTH, TRACKS, ROBOT, THINGS):
        for field in schema:
            if field.name.endswith(("_m", "_s", "_rad", "_px", "_c", "_m2", "_px2")):
                assert (field.metadata or {}).get(b"unit"), field.name
