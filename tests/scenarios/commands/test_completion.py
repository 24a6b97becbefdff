"""A shell that asks `peopleboy` what could come next."""

from __future__ import annotations

from collections.abc import Sequence

import pytest
from click.shell_completion import ShellComplete

from peopleboy.scenarios.cli import COMMANDS, cli
from peopleboy.scenarios.commands.completion import BEHAVIOUR_NAMES
from peopleboy.scenarios.commands.run_commands import run
from peopleboy.scenarios.files.library import library, suite_names
from peopleboy.tracker.trackers import TRACKERS


def asked(words: Sequence[str], start: str) -> list[str]:
    items = ShellComplete(cli, {}, "peopleboy", "_PEOPLEBOY_COMPLETE").get_completions(list(words), start)
    return [item.value if item.type == "plain" else f"{item.type}:{item.value}" for item in items]


def test_commands_are_completed() -> None:
    assert asked([], "re") == [command.name for command in COMMANDS if command.name[:2] == "re"]
    assert asked([], "sh") == ["show"]


def test_all_scenarios_and_suites_are_offered() -> None:
    assert asked(["run"], "") == sorted([*library(), *suite_names()])


@pytest.mark.parametrize("command", ["run", "show", "sweep", "render"])
def test_scenarios_and_suites_are_completed_and_else_files(command: str) -> None:
    assert asked([command], "crossing_p") == ["crossing_pair"]
    assert asked([command], "./my") == ["file:./my"]


def test_trackers_and_behaviours_are_completed_and_are_all_there_are() -> None:
    assert set(asked(["run", "pair", "--tracker"], "")) == {*TRACKERS, "truth"}
    assert asked(["run", "pair", "--behaviour"], "follow") == ["follow_corridor", "follow_person"]
    told = next(option.help for option in run.params if option.name == "behaviour")  # type: ignore[attr-defined]
    assert all(name in told for name in BEHAVIOUR_NAMES)


def test_the_script_for_a_shell_asks_peopleboy(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("_PEOPLEBOY_COMPLETE", "zsh_source")
    with pytest.raises(SystemExit):
        cli.main(args=[], prog_name="peopleboy")
    told = capsys.readouterr().out
    assert "#compdef peopleboy" in told
    assert "_PEOPLEBOY_COMPLETE=zsh_complete" in told
