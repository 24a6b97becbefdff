"""What rerun itself shows cannot be looked at here; that it is served, to whom, and that it ends, can."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote
from urllib.request import urlopen

import pytest

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.cli import main
from peopleboy.scenarios.recording.recorder import Recorder
from peopleboy.scenarios.recording.viewer import (
    NO_SCREEN,
    is_whole,
    live_viewer,
    open_viewer,
    recording_in,
    serve,
)
from tests.helpers import synthetic_ticks as made

LISTENING = "0A"  # in Linux's table of sockets
ON_LINUX = pytest.mark.skipif(not Path("/proc/net/tcp").exists(), reason="reads Linux's table of sockets")


@pytest.fixture(autouse=True)
def no_screen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("run")
    with Recorder(folder / "recording.rrd", made.config(), title="made") as recorder:
        for tick, events in made.make_run(3):
            recorder.log(tick, events)
    return folder


@pytest.fixture
def page(run: Path) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """`peopleboy view --web` in a process of its own, and the address that it prints."""
    command = [sys.executable, "-m", "peopleboy", "view", str(run), "--web"]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=Path(__file__).parents[3]
    )
    assert process.stdout is not None
    line = process.stdout.readline()
    yield process, line.split()[0]
    process.kill()
    process.communicate()


def listeners(port: int) -> set[str]:
    """Addresses of this machine at which something listens on a port."""
    found = set()
    for table in ("tcp", "tcp6"):
        for line in Path("/proc/net", table).read_text().splitlines()[1:]:
            address, hexadecimal = line.split()[1].split(":")
            if int(hexadecimal, 16) == port and line.split()[3] == LISTENING:
                found.add(address)
    return found


@ON_LINUX
def test_a_recording_is_served_to_this_machine_alone_until_interrupted(
    page: tuple[subprocess.Popen[str], str],
) -> None:
    process, address = page
    assert b"<html" in urlopen(address, timeout=10).read().lower()
    ports = [int(port) for port in re.findall(r"127\.0\.0\.1:(\d+)", unquote(address))]
    assert len(ports) == 2
    assert {address for port in ports for address in listeners(port)} == {"0100007F"}
    process.send_signal(signal.SIGTERM)
    assert process.communicate(timeout=20) == ("", "")
    assert process.returncode == 0
    assert [listeners(port) for port in ports] == [set(), set()]


def test_a_viewer_shows_a_run_while_it_is_recorded_and_the_file_is_written_too(tmp_path: Path) -> None:
    said: list[str] = []
    path = tmp_path / "recording.rrd"

    def run() -> None:
        with live_viewer(said.append) as source:
            assert source.startswith("rerun+http://127.0.0.1:")
            with Recorder(path, made.config(), title="made", viewer=source) as recorder:
                for tick, events in made.make_run(40):
                    recorder.log(tick, events)
            raise InterruptedError  # as if by Ctrl-C, or the page would be served for ever

    with pytest.raises(InterruptedError):
        run()
    assert len(said) == 1
    assert path.stat().st_size > 100_000


def test_without_a_screen_the_native_viewer_says_so_in_one_line(run: Path) -> None:
    with pytest.raises(BadInput, match=f"^{NO_SCREEN}$"):
        open_viewer(run / "recording.rrd")


@pytest.mark.parametrize("arguments", [("crossing_2", "--no-rrd"), ("dataset1",)])
def test_there_is_nothing_to_show_live_without_the_recording_of_one_run(
    arguments: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as stop:
        main(["run", "--live", *arguments])
    assert stop.value.code == 2
    assert capsys.readouterr().err.startswith("peopleboy: --live: shows the recording of one run")


@pytest.mark.parametrize(
    ("made_of", "why"),
    [
        ("nothing", "there is no such folder; give the folder of a finished run"),
        ("a file", "there is no such folder; give the folder of a finished run"),
        ("an empty folder", "holds no run and no recording; give the folder of a run"),
        ("runs", "holds 2 runs; give one of them, such as"),
        ("a run", "there is no recording; run the scenario without --no-rrd"),
        ("text", "is no rerun recording; run the scenario again"),
        ("an empty file", "is no rerun recording; run the scenario again"),
    ],
)
def test_what_holds_no_recording_is_refused_with_what_it_is(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], made_of: str, why: str
) -> None:
    folder = tmp_path / "given"
    if made_of == "a file":
        folder.write_text("no folder")
    elif made_of != "nothing":
        folder.mkdir()
    for inner in {"runs": ("a", "b"), "a run": (".",)}.get(made_of, ()):
        (folder / inner).mkdir(exist_ok=True)
        (folder / inner / "run.json").touch()
    for content in {"text": ["# Read me\n"], "an empty file": [""]}.get(made_of, []):
        (folder / "recording.rrd").write_text(content)
    with pytest.raises(SystemExit) as stop:
        main(["view", str(folder), "--web"])
    assert stop.value.code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert why in line


def test_a_recording_that_was_cut_off_is_told_from_a_whole_one_and_shown(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert is_whole(recording_in(run))
    part = tmp_path / "recording.rrd"
    part.write_bytes((run / "recording.rrd").read_bytes()[:-1000])
    assert not is_whole(part)
    with pytest.raises(SystemExit):
        main(["view", str(tmp_path)])
    cut_off, screen = capsys.readouterr().err.splitlines()
    assert cut_off == f"peopleboy: {part}: was cut off; what it holds is shown"
    assert screen == f"peopleboy: {NO_SCREEN}"


def test_a_missing_recording_is_a_user_s_mistake(tmp_path: Path) -> None:
    for show in (open_viewer, lambda path: serve(path, print)):
        with pytest.raises(BadInput, match="there is no recording"):
            show(tmp_path / "recording.rrd")
