"""Calls of the command line inside the tests' own process."""

from __future__ import annotations

import pytest

from peopleboy.scenarios.cli import main


def run_cli(*arguments: object) -> int:
    """Call `peopleboy` and return its exit code."""
    with pytest.raises(SystemExit) as leaving:
        main([str(each) for each in arguments])
    assert isinstance(leaving.value.code, int)
    return leaving.value.code


def refusal(capsys: pytest.CaptureFixture[str], *arguments: object, lines: int = 1) -> str:
    """Call `peopleboy`, which has to refuse, and return the one line, or so many, on standard error."""
    capsys.readouterr()
    assert run_cli(*arguments) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == lines, told
    return told
