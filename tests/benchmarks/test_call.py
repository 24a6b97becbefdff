import sys

import click
import pytest

from benchmarks import call
from peopleboy.bad_input import BadInput
from peopleboy.scenarios.running.engine.task import Failure, TasksFailed


@pytest.mark.parametrize(
    ("error", "word", "code"),
    [
        (BadInput("no such clip"), "no such clip", 2),
        (click.BadParameter("must be at least 1"), "must be at least 1", 2),
        (TasksFailed("clips", [Failure("street", "out of memory")], 3), "street", 1),
    ],
)
def test_an_error_is_told_without_a_traceback(
    error: Exception,
    word: str,
    code: int,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    @click.command()
    def command() -> None:
        raise error

    monkeypatch.setattr(sys, "argv", ["bench"])
    with pytest.raises(SystemExit) as ended:
        call(command, "benchmarks.bench")
    told = capsys.readouterr()
    assert ended.value.code == code
    assert told.out == ""
    assert told.err.startswith("benchmarks.bench: ")
    assert word in told.err
