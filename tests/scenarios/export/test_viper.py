from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.scenarios.export.viper import whole_pixels
from tests.helpers.runs.exported import export

V, D = "{http://lamp.cfar.umd.edu/viper#}", "{http://lamp.cfar.umd.edu/viperdata#}"
# By ViPER's schema.
KINDS = {"bvalue", "bbox", "dvalue", "fvalue", "lvalue", "svalue"}

# In steps of 1/64 px, whose sums are exact.
edges = st.integers(-500 * 64, 500 * 64).map(lambda steps: steps / 64)
sizes = st.integers(1, 400 * 64).map(lambda steps: steps / 64)


@pytest.fixture(scope="module")
def folder(crossing: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(crossing, "viper", tmp_path_factory.mktemp("viper") / "set") / "tiny-3"


def values(thing: ElementTree.Element, name: str) -> dict[int, ElementTree.Element]:
    """The values of an attribute by frame."""
    attribute = next(found for found in thing.iter(f"{V}attribute") if found.get("name") == name)
    found = {}
    for value in attribute:
        first, last = map(int, value.attrib["framespan"].split(":"))
        found |= dict.fromkeys(range(first, last + 1), value)
    return found


def frames(spans: str) -> set[int]:
    ends = [tuple(map(int, span.split(":"))) for span in spans.split()]
    return {frame for first, last in ends for frame in range(first, last + 1)}


@pytest.mark.parametrize(("file", "text"), [("truth.xgtf", "truth/gt.txt"), ("tracks.xgtf", "tracks.txt")])
def test_another_parser_reads_back_every_box(file: str, text: str, folder: Path, crossing: Path) -> None:
    table = np.loadtxt(crossing / text, delimiter=",", ndmin=2)
    root = ElementTree.parse(folder / file).getroot()
    objects = {int(thing.attrib["id"]): thing for thing in root.iter(f"{V}object")}
    assert set(objects) == {int(number) for number in table[:, 1]}
    for number, thing in objects.items():
        rows = {int(row[0]): row for row in table[table[:, 1] == number]}
        assert frames(thing.attrib["framespan"]) == set(rows)
        for k, edge in enumerate(("LEFT", "TOP", "WIDTH", "HEIGHT"), start=2):
            read = {frame: float(value.attrib["value"]) for frame, value in values(thing, edge).items()}
            assert read == {frame: row[k] for frame, row in rows.items()}
        for frame, value in values(thing, "LOCATION").items():
            x, y, width, height = (int(value.attrib[name]) for name in ("x", "y", "width", "height"))
            assert 0 <= x < x + width <= 160
            assert 0 <= y < y + height <= 120
            left, top, w, h = rows[frame][2:6] + np.array([0.5, 0.5, 0.0, 0.0])
            inside = np.clip([left, top, left + w, top + h], 0, [160, 120, 160, 120])
            assert np.abs(inside - (x, y, x + width, y + height)).max() < 1.0


@pytest.mark.parametrize("file", ["truth.xgtf", "tracks.xgtf"])
def test_objects_have_the_attributes_that_the_file_announces(file: str, folder: Path) -> None:
    root = ElementTree.parse(folder / file).getroot()
    assert [child.tag for child in root] == [f"{V}config", f"{V}data"]
    announced = {
        descriptor.attrib["name"]: {
            attribute.attrib["name"]: attribute.attrib["type"].removeprefix(D.strip("{}"))
            for attribute in descriptor
        }
        for descriptor in root[0]
    }
    assert set(announced) == {"Information", "PERSON"}
    source = root[1][0]
    assert source.tag == f"{V}sourcefile"
    for thing in source:
        for attribute in thing:
            kind = announced[thing.attrib["name"]][attribute.attrib["name"]]
            assert kind in KINDS
            assert {value.tag for value in attribute} <= {f"{D}{kind}"}
    told = {attribute.attrib["name"]: attribute[0].attrib["value"] for attribute in source[0]}
    assert told["NUMFRAMES"] == "60"
    assert (told["H-FRAME-SIZE"], told["V-FRAME-SIZE"]) == ("160", "120")


@given(left=edges, top=edges, width=sizes, height=sizes)
def test_whole_pixels_are_those_that_the_box_touches(
    left: float, top: float, width: float, height: float
) -> None:
    def touched(low: float, size: float, count: int) -> list[int]:
        return [k for k in range(count) if k + 0.5 > low and k - 0.5 < low + size]

    columns, rows = touched(left, width, 32), touched(top, height, 24)
    found = whole_pixels((left, top, width, height), 32, 24)
    if found is None:
        assert not columns or not rows
    else:
        x, y, w, h = found
        assert (columns, rows) == (list(range(x, x + w)), list(range(y, y + h)))
