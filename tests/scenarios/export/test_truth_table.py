"""The table of docs/truth.md names every field, and no other."""

from __future__ import annotations

import json
import re
from dataclasses import fields
from pathlib import Path

import pytest

from peopleboy.scenarios.export import viper
from peopleboy.scenarios.export.coco import annotations_file
from peopleboy.scenarios.loop.run_events import LogLine
from peopleboy.scenarios.run_folder.run_tables import ROBOT, TRACKS, TRUTH

PAGE = Path(__file__).parents[3] / "docs" / "truth.md"
ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")]
    for line in PAGE.read_text(encoding="utf-8").splitlines()
    if line.startswith("| ") and not line.startswith("| file")
]


def told(file: str) -> list[str]:
    """The fields that the table has for a file or format, one after the other."""
    found = [row[1] for row in ROWS if file in re.findall(r"`([^`]*)`", row[0])]
    return [name for cell in found for name in re.findall(r"`([^`]*)`", cell)]


@pytest.mark.parametrize(
    ("file", "names"),
    [
        ("truth.parquet", TRUTH.names),
        ("tracks.parquet", TRACKS.names),
        ("robot.parquet", ROBOT.names),
        ("events.jsonl", [field.name for field in fields(LogLine)]),
    ],
)
def test_every_column_is_in_the_table_once(file: str, names: list[str]) -> None:
    assert sorted(told(file)) == sorted(names)


def test_every_row_has_unit_frame_and_exactness() -> None:
    assert len(ROWS) > 60
    for row in ROWS:
        assert len(row) == 6
        assert all(row)
        assert row[4] in {"exact", "modelled", "drawn", "estimated"}, row


def test_every_field_of_the_coco_export_is_in_the_table(coco_folder: Path) -> None:
    content = json.loads((coco_folder / annotations_file()).read_text())
    (video,) = content["videos"]
    keys = {*content["annotations"][0], *content["images"][0], *video["cameras"]["thermal"], "thermal_span_c"}
    assert set(told("coco")) == keys


def test_every_attribute_of_the_viper_export_is_in_the_table() -> None:
    assert set(told("viper")) == {*viper.OBJECT, *viper.ALL_ROUND, *viper.TRUTH, *viper.TRACK}


@pytest.mark.parametrize("file", ["thermal/", "thermal16/", "colour/", "mot", "mcap", "mp4"])
def test_images_and_the_other_exports_are_in_the_table(file: str) -> None:
    assert told(file)
