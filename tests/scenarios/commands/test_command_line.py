"""What all commands have in common: groups, options that are declared once, JSON, the log."""

from __future__ import annotations

import json
import logging
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

from peopleboy.scenarios.cli import COMMANDS, SECTIONS, cli
from peopleboy.scenarios.commands.command_options import british, seeds_options
from peopleboy.scenarios.files.library import library, suites
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.suite import load_suite
from tests.helpers.calls.command_line import refusal, run_cli

PRINTS_NO_DATA = {"view", "schema", "train"}  # a viewer, JSON anyway, and a group


@pytest.fixture(autouse=True)
def _quiet_log() -> Iterator[None]:
    yield
    logging.getLogger("peopleboy").setLevel(logging.WARNING)


def options_of_command(command: click.Command) -> dict[str, click.Option]:
    options = (param for param in command.params if isinstance(param, click.Option))
    return {name: option for option in options for name in option.opts}


def test_the_help_lists_every_command_once_below_its_heading(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_cli("--help") == 0
    lines = capsys.readouterr().out.splitlines()
    assert "Simulate, track and evaluate people around a mobile robot." in lines[2]
    at = [lines.index(f"{title}:") for title in SECTIONS]
    assert at == sorted(at)
    for command in COMMANDS:
        assert len([line for line in lines if line.startswith(f"  {command.name} ")]) == 1
    assert set(cli.commands) == {command.name for command in COMMANDS}


def test_summaries_are_not_cut_on_a_terminal_of_80_columns(capsys: pytest.CaptureFixture[str]) -> None:
    run_cli("--help")
    assert "..." not in capsys.readouterr().out.split("Core:")[1]


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.name)
def test_every_command_logs_on_demand_and_prints_json(command: click.Command) -> None:
    options = options_of_command(command)
    assert command.name == "train" or "--verbose" in options
    assert ("--json" in options) is (command.name not in PRINTS_NO_DATA)
    assert ("--quiet" in options) is ("--json" in options)


def test_a_count_of_seeds_has_one_name_everywhere() -> None:
    counts = {f"--{word}" for word in ("repeats", "worlds", "scenes", "rounds", "sequences", "number")}
    for command in COMMANDS:
        assert not counts & options_of_command(command).keys()
    ranged = [one.name for one in COMMANDS if "--first-seed" in options_of_command(one)]
    assert sorted(ranged) == ["compare", "render", "sweep", "tune"]


def test_seeds_are_a_range() -> None:
    found: list[range] = []

    @click.command()
    @seeds_options(4, first=100)
    def counted(seeds: range) -> None:
        found.append(seeds)

    counted.main([], standalone_mode=False)
    counted.main(["--seeds", "2", "--first-seed", "7"], standalone_mode=False)
    assert found == [range(100, 104), range(7, 9)]


def test_scenarios_are_arguments_everywhere() -> None:
    assert not [one.name for one in COMMANDS if "--scenario" in options_of_command(one)]


@pytest.mark.parametrize(
    ("american", "ours"),
    [("--behavior", "--behaviour"), ("color", "colour"), ("--randomize", "--randomise"), ("--out", "--out")],
)
def test_american_spellings_are_those_of_the_options(american: str, ours: str) -> None:
    assert british(american) == ours


def test_values_that_are_american_are_shown_as_they_are(capsys: pytest.CaptureFixture[str]) -> None:
    assert "'gray16be'" in refusal(capsys, "track", "-", "--size", "8x8", "--pixels", "gray8")


def test_an_american_option_is_taken(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    order = ("run", "empty_room", "--out", tmp_path / "run", "--behavior", "stands")
    assert "'stands'" in refusal(capsys, *order)
    assert run_cli("run", "empty_room", "--out", tmp_path / "run", "--tracker", "colors") == 2
    assert "unknown tracker 'colours'" in capsys.readouterr().err


def test_the_list_has_duration_and_people(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_cli("list") == 0
    head, *lines = capsys.readouterr().out.splitlines()
    assert head.split() == ["name", "time", "people", "description"]
    assert len(lines) == len(library()) + len(suites())
    row = next(line for line in lines if line.startswith("crossing_2 "))
    assert row.split()[:4] == ["crossing_2", "16", "s", "2"]


def test_the_list_is_filtered_by_words(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_cli("list", "crossing", "ROBOT", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert {"crossing_2", "crossing_3"} <= {entry["name"] for entry in found} < {*library(), *suites()}
    assert "no scenario or suite contains 'nothing such'" in refusal(capsys, "list", "nothing", "such")


@pytest.mark.parametrize("name", ["crossing_2_moving", "group_abreast", "crowd_8", "empty_room"])
def test_the_list_agrees_with_the_scenario(name: str) -> None:
    scenario, entry = load_scenario(name), library()[name]
    assert entry.description == scenario.description
    assert entry.duration_s == scenario.duration_s
    assert entry.people == len(scenario.people(0))


def test_the_list_agrees_with_the_suites() -> None:
    for name, entry in suites().items():
        assert entry.runs == sum(len(each.seeds) for each in load_suite(name).runs)


def test_verbose_logs_to_standard_error_and_leaves_json_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_cli("show", "empty_room", "--out", tmp_path / "a.png", "--json", "--verbose") == 0
    printed = capsys.readouterr()
    assert json.loads(printed.out)["scenario"]["name"] == "empty_room"
    assert "s: scenario empty_room from" in printed.err
    assert run_cli("show", "empty_room", "--out", tmp_path / "a.png") == 0
    printed = capsys.readouterr()
    assert printed.out.strip() == str(tmp_path / "a.png")
    assert not printed.err


def test_notes_are_logged_as_such_and_quiet_silences_them(capsys: pytest.CaptureFixture[str]) -> None:
    from peopleboy.scenarios.commands.command_options import configure_logging, print_note

    configure_logging()
    print_note("it is late")
    configure_logging(logging.ERROR)
    print_note("it is later")
    assert capsys.readouterr().err == "peopleboy: note: it is late\n"
