"""What rerun itself shows cannot be looked at here; that it is served, to whom, and that it ends, can."""

from __future__ import annotations

import re
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from urllib.parse import unquote
from urllib.request import urlopen

import pytest

from peopleboy.scenarios.recording.recorder import Recorder
from peopleboy.scenarios.recording.recording_file import is_whole
from peopleboy.scenarios.recording.viewer import live_viewer
from tests.helpers.calls.command_line import refusal
from tests.helpers.runs import synthetic_ticks as made

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
def port() -> int:
    """A port that is free, and so is the next."""
    while True:
        with ExitStack() as held, socket.create_server(("127.0.0.1", 0)) as first:
            try:
                held.enter_context(socket.create_server(("127.0.0.1", first.getsockname()[1] + 1)))
            except (OSError, OverflowError):
                continue
            return int(first.getsockname()[1])


@pytest.fixture
def page(run: Path, port: int) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """`peopleboy view --web` in a process of its own, and the address that it prints."""
    command = [sys.executable, "-m", "peopleboy", "view", str(run), "--web", "--port", str(port)]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=Path(__file__).parents[3]
    )
    assert process.stdout is not None
    line = process.stdout.readline()
    yield process, re.findall(r"http:\S+", line)[0]
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


@pytest.mark.slow
@ON_LINUX
def test_a_recording_is_served_at_two_ports_to_this_machine_alone_until_interrupted(
    page: tuple[subprocess.Popen[str], str], port: int
) -> None:
    process, address = page
    assert b"<html" in urlopen(address, timeout=10).read().lower()
    ports = [int(found) for found in re.findall(r"127\.0\.0\.1:(\d+)", unquote(address))]
    assert ports == [port, port + 1]
    assert {address for port in ports for address in listeners(port)} == {"0100007F"}
    process.send_signal(signal.SIGTERM)
    assert process.communicate(timeout=20) == ("", "")
    assert process.returncode == 0
    assert [listeners(port) for port in ports] == [set(), set()]


@pytest.mark.parametrize("taken", [0, 1])
def test_a_port_that_is_taken_is_refused(
    run: Path, port: int, taken: int, capsys: pytest.CaptureFixture[str]
) -> None:
    with socket.create_server(("127.0.0.1", port + taken)):
        told = refusal(capsys, "view", run, "--web", "--port", port)
    assert f"--port {port}" in told
    assert str(port + 1) in told


@pytest.mark.parametrize("arguments", [("--port", "9090"), ("--web", "--port", "65535")])
def test_a_port_needs_a_page_and_the_next_port(
    run: Path, arguments: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    assert "--port" in refusal(capsys, "view", run, *arguments)


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


def test_without_a_screen_the_window_s_refusal_names_the_other_way(
    run: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "--web" in refusal(capsys, "view", run)


def test_a_viewer_that_fails_is_told_from_one_that_was_closed(
    run: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("DISPLAY", ":9999")
    assert str(run / "recording.rrd") in refusal(capsys, "view", run)


@pytest.mark.parametrize("arguments", [("crossing_2", "--no-recording"), ("dataset1",)])
def test_there_is_nothing_to_show_live_without_the_recording_of_one_run(
    arguments: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    assert "--live" in refusal(capsys, "run", "--live", *arguments)


@pytest.mark.parametrize(
    ("made_of", "named"),
    [
        ("nothing", "given"),
        ("a file", "given"),
        ("an empty folder", "given"),
        ("runs", "given/a"),
        ("a run", "given/recording.rrd"),
        ("text", "given/recording.rrd"),
        ("an empty file", "given/recording.rrd"),
    ],
)
def test_what_holds_no_recording_is_refused_and_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], made_of: str, named: str
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
    assert str(tmp_path / named) in refusal(capsys, "view", folder, "--web")


def test_a_recording_that_was_cut_off_is_told_from_a_whole_one_and_shown(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert is_whole(run / "recording.rrd")
    part = tmp_path / "recording.rrd"
    part.write_bytes((run / "recording.rrd").read_bytes()[:-1000])
    assert not is_whole(part)
    cut_off, screen = refusal(capsys, "view", tmp_path, lines=2).splitlines()
    assert str(part) in cut_off
    assert "--web" in screen
