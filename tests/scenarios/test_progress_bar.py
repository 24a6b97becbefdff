import pytest

from peopleboy.scenarios import progress_bar
from peopleboy.scenarios.progress_bar import EVERY_S, ProgressStyle, progress_as
from peopleboy.scenarios.progress_bar import progress_bar as shown


class Clock:
    """A clock that a test sets."""

    now_s = 0.0

    def monotonic(self) -> float:
        return self.now_s


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(progress_bar, "time", made)
    return made


def work(clock: Clock, style: ProgressStyle, seconds: int, unit: str | None = "frames") -> None:
    """Work for so many seconds, at 10 frames per second, off a terminal."""
    with progress_as(style), shown("render", unit) as show:
        for second in range(1, seconds + 1):
            clock.now_s = second
            show(10 * second, 10 * seconds, f"{second} done")


def test_off_a_terminal_a_line_is_printed_every_30_seconds_and_at_the_end(
    clock: Clock, capsys: pytest.CaptureFixture[str]
) -> None:
    work(clock, ProgressStyle.AUTO, 70)
    assert capsys.readouterr().err.splitlines() == [
        "render: 300 of 700 frames, 10 frames/s, 30 done, 40 s left",
        "render: 600 of 700 frames, 10 frames/s, 60 done, 10 s left",
        "render: 700 of 700 frames, 10 frames/s, 70 done",
    ]


def test_short_work_prints_a_line_only_if_lines_are_asked_for(
    clock: Clock, capsys: pytest.CaptureFixture[str]
) -> None:
    work(clock, ProgressStyle.AUTO, int(EVERY_S) - 1)
    assert capsys.readouterr().err == ""
    clock.now_s = 0.0
    work(clock, ProgressStyle.PLAIN, 5, unit=None)
    assert capsys.readouterr().err == "render: 50 of 50, 5 done\n"


def test_the_first_unit_with_which_kernels_are_compiled_does_not_count_for_the_rate(
    clock: Clock, capsys: pytest.CaptureFixture[str]
) -> None:
    with progress_as(ProgressStyle.AUTO), shown("run", "frames") as show:
        for second, frames in ((50, 1), (80, 301)):
            clock.now_s = second
            show(frames, 330)
    assert capsys.readouterr().err.splitlines() == [
        "run: 1 of 330 frames",
        "run: 301 of 330 frames, 10 frames/s, 3 s left",
    ]


def test_hidden_progress_prints_nothing(clock: Clock, capsys: pytest.CaptureFixture[str]) -> None:
    work(clock, ProgressStyle.HIDDEN, 300)
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(12.4, "12 s"), (59.9, "60 s"), (60.0, "1 min"), (600.0, "10 min"), (9000.0, "2.5 h")],
)
def test_durations_are_given_in_the_unit_that_fits(seconds: float, text: str) -> None:
    assert progress_bar._duration(seconds) == text
