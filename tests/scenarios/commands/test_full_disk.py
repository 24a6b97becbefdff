import errno
import os
from pathlib import Path

import pytest

from peopleboy.scenarios import cli


def ended_with(arguments: list[str]) -> object:
    with pytest.raises(SystemExit) as end:
        cli.main(arguments)
    return end.value.code


def test_an_error_of_the_system_is_told_in_a_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def write(number: int) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(cli.cli, "main", lambda **_: write(errno.ENOSPC))
    assert ended_with(["list"]) == cli.FAILED
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "the disk is full" in told
    monkeypatch.setattr(cli.cli, "main", lambda **_: write(errno.EIO))
    assert ended_with(["list"]) == cli.FAILED
    assert capsys.readouterr().err.startswith("peopleboy: [Errno 5]")


def test_an_error_that_the_system_does_not_number_is_not_hidden(monkeypatch: pytest.MonkeyPatch) -> None:
    def read() -> None:
        raise OSError("a library's own")

    monkeypatch.setattr(cli.cli, "main", lambda **_: read())
    with pytest.raises(OSError, match="a library's own"):
        cli.main(["list"])


def test_a_plan_is_not_written_under_another_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert ended_with(["show", "empty_room", "--out", str(tmp_path / "plan")]) == cli.BAD_INPUT
    assert "ends in .png" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
