"""Rerun's viewer: in a window, or as a page that only this machine can open."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from urllib.parse import quote

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.finished_run import runs_in

LOOPBACK = "127.0.0.1"
NO_SCREEN = "no screen here: --web serves it to a browser"

# What a file of rerun's begins with, and what ends one that was closed.
_HEAD, _FOOT, _FOOT_BYTES = b"RRF2", b"RRF2FOOT", 12

_START_S = 30.0  # within which a viewer is there, or fails
_POLL_S = 0.1
# It tells every step of its work otherwise.
_QUIET = {"RUST_LOG": "error"}


def has_screen() -> bool:
    """Tell whether there is a screen to open a window on."""
    if sys.platform in ("win32", "darwin"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def recording_in(folder: Path) -> Path:
    """Find the recording of a run, of one that was cut off too.

    Raises:
        BadInput: there is no such folder, it holds no run or several, or the run was not recorded.
    """
    inner = runs_in(folder)
    if inner != [folder]:
        raise BadInput(f"{folder}: holds {len(inner)} runs; give one of them, such as {inner[0]}")
    recording = folder / "recording.rrd"
    if not recording.is_file() and not (folder / "run.json").is_file():
        raise BadInput(f"{folder}: holds no run and no recording; give the folder of a run")
    return recording


def is_whole(recording: Path) -> bool:
    """Tell whether a recording was closed; one that was cut off opens too, and lacks its end.

    Raises:
        BadInput: there is no such recording, or the file is none.
    """
    _check(recording)
    with recording.open("rb") as file:
        file.seek(-min(_FOOT_BYTES, recording.stat().st_size), os.SEEK_END)
        return _FOOT in file.read()


def open_viewer(recording: Path) -> None:
    """Show a recording in a window, and wait until it is closed.

    Raises:
        BadInput: there is no such recording, no screen, or the viewer fails.
    """
    _check(recording)
    if not has_screen():
        raise BadInput(NO_SCREEN)
    with _rerun(str(recording), "--port", str(_free_port())) as viewer:
        if viewer.wait() != 0:
            raise BadInput(f"{recording}: {_complaint(viewer)}")


def serve(recording: Path, say: Callable[[str], None]) -> None:
    """Serve a recording to browsers of this machine, until interrupted.

    Args:
        recording: the file.
        say: is told the page's address once it is there.

    Raises:
        BadInput: there is no such recording, or the server fails.
    """
    _check(recording)
    with _page(str(recording)) as (viewer, address, _):
        say(address)
        _wait(viewer)


@contextmanager
def live_viewer(say: Callable[[str], None]) -> Iterator[str]:
    """Have a viewer ready for a run: a window, or a page if there is no screen; yield where it takes data.

    A window stays open afterwards. A page is served until interrupted.

    Args:
        say: is told where to look.

    Raises:
        BadInput: the viewer fails.
    """
    if not has_screen():
        with _page() as (viewer, address, source):
            say(f"{address} shows the run as it goes.")
            yield source
            say(f"{address} still shows it; Ctrl-C ends that.")
            _wait(viewer)
        return
    port = _free_port()
    with _rerun("--port", str(port), "--expect-data-soon", is_left_open=True) as viewer:
        _wait_for(port, viewer)
        yield _source(port)


@contextmanager
def _page(*recordings: str) -> Iterator[tuple[subprocess.Popen[bytes], str, str]]:
    """Serve the viewer as a page; yield its process, the page's address, and where it takes data."""
    port, web_port = _free_port(), _free_port()
    with _rerun(
        *recordings, "--serve-web", "--port", str(port), "--web-viewer-port", str(web_port)
    ) as viewer:
        for each in (port, web_port):
            _wait_for(each, viewer)
        yield viewer, f"http://{LOOPBACK}:{web_port}/?url={quote(_source(port), safe='')}", _source(port)


@contextmanager
def _rerun(*arguments: str, is_left_open: bool = False) -> Iterator[subprocess.Popen[bytes]]:
    """Start rerun's program, for this machine alone; end it afterwards, unless it is left open."""
    command = [sys.executable, "-m", "rerun_cli", "--bind", LOOPBACK, *arguments]
    # In a session of its own, an interrupt reaches it through us, and all of it can be ended.
    viewer = subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL if is_left_open else subprocess.PIPE,
        env=os.environ | _QUIET, start_new_session=True,
    )  # fmt: skip
    try:
        yield viewer
    finally:
        if not is_left_open:
            _end(viewer)


def _end(viewer: subprocess.Popen[bytes]) -> None:
    if hasattr(os, "killpg"):
        # Its child may outlive it.
        with suppress(ProcessLookupError):
            os.killpg(viewer.pid, signal.SIGTERM)
    else:
        viewer.terminate()
    viewer.communicate()


def _wait(viewer: subprocess.Popen[bytes]) -> None:
    """Wait until the user has had enough, by Ctrl-C or by ending this process."""
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        viewer.wait()
    except KeyboardInterrupt:
        return
    finally:
        signal.signal(signal.SIGTERM, before)
    raise BadInput(_complaint(viewer))


def _wait_for(port: int, viewer: subprocess.Popen[bytes]) -> None:
    """Wait until something listens on a port."""
    end_s = time.monotonic() + _START_S
    while time.monotonic() < end_s and viewer.poll() is None:
        with socket.socket() as probe:
            if probe.connect_ex((LOOPBACK, port)) == 0:
                return
        time.sleep(_POLL_S)
    raise BadInput(_complaint(viewer))


def _complaint(viewer: subprocess.Popen[bytes]) -> str:
    """Say in one line what rerun says last."""
    if viewer.poll() is None or viewer.stderr is None:
        return "rerun's viewer does not start"
    lines = viewer.stderr.read().decode(errors="replace").strip().splitlines()
    return f"rerun's viewer failed: {lines[-1] if lines else f'exit code {viewer.returncode}'}"


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind((LOOPBACK, 0))
        port: int = probe.getsockname()[1]
        return port


def _source(port: int) -> str:
    return f"rerun+http://{LOOPBACK}:{port}/proxy"


def _check(recording: Path) -> None:
    if not recording.is_file():
        raise BadInput(f"{recording}: there is no recording; run the scenario without --no-rrd")
    try:
        with recording.open("rb") as file:
            is_recording = file.read(len(_HEAD)) == _HEAD
    except OSError as error:
        raise BadInput(f"{recording}: cannot be read: {error.strerror}") from error
    if not is_recording:
        raise BadInput(f"{recording}: is no rerun recording; run the scenario again")
