import re
from functools import cache
from typing import Any

import click
import pytest

from docs.generate import scenario_keys
from docs.generate.offline import loads
from docs.generate.parts import PARTS, PLACE, fill_in, outdated_pages
from docs.generate.reference.settings import COLUMNS, commented_settings
from peopleboy.scenarios.cli import cli
from peopleboy.scenarios.files.robot import RobotSpec
from peopleboy.scenarios.files.scenario_file import FaultSpec, json_schema
from peopleboy.settings import settings_of
from peopleboy.sim.people.person_config import Reaction, Waypoint
from peopleboy.tracker.evaluation.table import FIGURES
from peopleboy.tracker.reproductions.contour import contour_config
from peopleboy.tracker.trackers import TRACKERS
from tests.helpers.pages import DOCS

PARTS_OF_A_FILE = scenario_keys.parts_of_a_file()
KEYS = list(scenario_keys.keys_of(PARTS_OF_A_FILE))


@cache
def page(name: str) -> str:
    return (DOCS / "reference" / name).read_text(encoding="utf-8")


def test_the_pages_are_what_the_code_makes_of_them() -> None:
    outdated = [path.name for path, _ in outdated_pages()]
    assert not outdated, "`make pages` writes them anew"


@pytest.mark.parametrize("part", PARTS_OF_A_FILE)
def test_every_key_of_a_scenario_file_is_documented_with_a_meaning(part: str) -> None:
    listed = {key.name: key for key in KEYS if key.part == part}
    assert listed.keys() == PARTS_OF_A_FILE[part]["properties"].keys()
    assert all(key.values and key.meaning for key in listed.values())
    text = page("scenario.md")
    assert all(f"| `{name}` |" in text for name in listed)


def test_every_part_of_a_scenario_file_is_documented() -> None:
    assert PARTS_OF_A_FILE.keys() == {"ScenarioSpec", *json_schema()["$defs"]}


def test_the_page_shows_limits_defaults_and_units_of_the_schema() -> None:
    key = next(key for key in KEYS if (key.part, key.name) == ("Door", "width_m"))
    door = json_schema()["$defs"]["Door"]["properties"]["width_m"]
    assert (key.unit, key.values) == ("m", f"{door['minimum']:g} to {door['maximum']:g}")
    assert key.default == f"`{door['default']}`"


@pytest.mark.parametrize(
    ("config", "key"),
    [(Waypoint, "posture"), (RobotSpec, "behaviour"), (FaultSpec, "kind"), (Reaction, "as")],
)
def test_what_can_be_chosen_is_what_is_described(config: type[Any], key: str) -> None:
    setting = next(one for one in settings_of(config) if one.key == key)
    assert set(re.findall(r"`(\w+)`", setting.meaning)) >= set(setting.choices)


def test_the_trackers_that_there_are_are_those_described() -> None:
    assert all(entry.summary and entry.scope for entry in TRACKERS.shipped.values())


def test_every_name_that_the_schema_allows_is_on_the_page() -> None:
    def words(value: object) -> set[str]:
        if isinstance(value, dict):
            own = set(value.get("enum", ())) if isinstance(value.get("enum"), list) else set()
            return own.union(*(words(inner) for inner in value.values()))
        return set().union(*(words(inner) for inner in value)) if isinstance(value, list) else set()

    text = page("scenario.md")
    assert not [word for word in words(json_schema()) if f"`{word}`" not in text]


def test_every_command_and_option_is_documented() -> None:
    text = page("commands.md")
    for name, command in cli.commands.items():
        assert f"## peopleboy {name}" in text
        options = [option for option in command.params if isinstance(option, click.Option)]
        assert all(max(option.opts, key=len) in text for option in options)


def test_every_figure_is_documented() -> None:
    text = page("metrics.md")
    assert all(f"**{figure.name}**" in text and figure.meaning in text for figure in FIGURES)


def test_settings_are_read_with_the_comments_above_and_beside_them() -> None:
    text = (
        "class A:\n"
        "    one: int = 1  # beside\n"
        "    # above, and on\n"
        "    # two lines\n"
        "    two: tuple[int, ...] = (\n"
        "        2,\n"
        "    )\n"
    )
    found = commented_settings(text, "A")
    assert [(setting.name, setting.comment) for setting in found] == [
        ("one", "beside"),
        ("two", "above, and on two lines"),
    ]


def test_the_settings_page_has_the_values_of_the_trackers() -> None:
    text = page("settings.md")
    assert COLUMNS["contour"].life.death_frames != contour_config.LifeConfig().death_frames
    assert f"| **{COLUMNS['contour'].life.death_frames}** |" in text


def test_every_part_is_asked_for_by_one_page() -> None:
    asked = [name for path in DOCS.rglob("*.md") for name in PLACE.findall(path.read_text(encoding="utf-8"))]
    assert sorted(asked) == sorted(PARTS)


def test_a_part_is_made_anew_in_its_place_and_once_only() -> None:
    once = fill_in("before\n<!-- generated: walls -->old<!-- end -->\nafter")
    assert once.startswith("before\n<!-- generated: walls -->\n\n| place | walls |")
    assert once.endswith("|\n\n<!-- end -->\nafter")
    assert "old" not in once
    assert fill_in(once) == once


def test_an_unknown_part_is_refused() -> None:
    with pytest.raises(KeyError):
        fill_in("<!-- generated: nothing --><!-- end -->")


def test_what_a_page_loads_from_a_network_is_found_and_links_are_left_alone() -> None:
    assert loads('<a href="https://x.org">x</a> <img src="../a.png"><script src="a.js"></script>') == []
    assert loads('<script async src="https://x.org/a.js">') == ["https://x.org/a.js"]
    assert loads("<link rel=stylesheet href=//x.org/a.css>") == ["//x.org/a.css"]
    assert loads("a { background: url('https://x.org/a.png') }") == ["https://x.org/a.png"]


def test_pictures_are_small() -> None:
    sizes = [path.stat().st_size for path in (DOCS / "pictures").glob("*.png")]
    assert max(sizes) < 200_000
    assert sum(sizes) < 2_100_000
