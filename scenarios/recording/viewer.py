"""Start rerun's viewer: in a window, or as a page that only this machine can open.

Rerun's Python functions `spawn`, `serve_grpc` and `serve_web_viewer` listen at every address of the machine.
Only its program has an option that prevents this.
"""

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from urllib.parse import quote

from peopleboy.bad_input import BadInput

LOOPBACK = "127.0.0.1"
NO_SCREEN = "no display is available; --web serves the recording to a browser"

# `-m rerun_cli` hides the exit code.
_PROGRAM = "import sys; from rerun_cli.__main__ import main; sys.exit(main())"
_START_S = 30.0  # within which a viewer starts, or fails
_POLL_S = 0.1
# Otherwise it logs every step, and sends usage statistics over the network unless it runs on a build machine.
_QUIET = {"RUST_LOG": "error", "CI": "true"}


def has_screen() -> bool:
    """Return whether there is a display to open a window on."""
    if sys.platform in ("win32", "darwin"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def open_viewer(recordings: Sequence[Path]) -> None:
    """Show a recording and its overlays in a window, and wait until it is closed.

    Raises:
        BadInput: there is no display, or the viewer fails.
    """
    if not has_screen():
        raise BadInput(NO_SCREEN)
    with _rerun("--new", *map(str, recordings)) as viewer:
        if viewer.wait() != 0:
            raise BadInput(f"{recordings[0]}: {_complaint(viewer)}")


def serve(recordings: Sequence[Path], say: Callable[[str], None], port: int | None = None) -> None:
    """Serve a recording and its overlays to browsers of this machine, until interrupted.

    Args:
        recordings: the files.
        say: called with the page's address once it is served.
        port: port of the page; its data uses the next one. None for any two free ports.

    Raises:
        BadInput: a port is in use, or the server fails.
    """
    with _page(port, *map(str, recordings)) as (viewer, address, _):
        say(address)
        _wait(viewer)


@contextmanager
def live_viewer(say: Callable[[str], None], *, is_left_open: bool = True) -> Iterator[str]:
    """Start a viewer, a window or, without a display, a page; yield the address that accepts data.

    Args:
        say: called with the address of the page.
        is_left_open: whether a window stays open afterwards, and a page is served until interrupted.

    Raises:
        BadInput: the viewer fails.
    """
    if not has_screen():
        with _page(None) as (viewer, address, source):
            say(f"Live view: {address}")
            yield source
            if is_left_open:
                say(f"The run is finished; the viewer stays open at {address} (stop with Ctrl-C)")
                _wait(viewer)
        return
    port, _ = _ports(None)
    with _rerun("--port", str(port), "--expect-data-soon", is_left_open=is_left_open) as viewer:
        _wait_for(port, viewer)
        yield _source(port)


@contextmanager
def _page(first: int | None, *recordings: str) -> Iterator[tuple[subprocess.Popen[bytes], str, str]]:
    """Serve the viewer as a page; yield its process, the page's address, and the address for data."""
    web, data = _ports(first)
    ports = ("--port", str(data), "--web-viewer-port", str(web))
    with _rerun(*recordings, "--serve-web", *ports) as viewer:
        _wait_for(data, viewer)
        _wait_for(web, viewer)
        yield viewer, f"http://{LOOPBACK}:{web}/?url={quote(_source(data), safe='')}", _source(data)


@contextmanager
def _rerun(*arguments: str, is_left_open: bool = False) -> Iterator[subprocess.Popen[bytes]]:
    """Start rerun's program for this machine only; stop it afterwards, unless it is left open."""
    command = [sys.executable, "-c", _PROGRAM, "--bind", LOOPBACK, *arguments]
    # In its own session, it receives interrupts only from here, and its whole process group can be stopped.
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
        # Its child process may outlive it.
        with suppress(ProcessLookupError):
            os.killpg(viewer.pid, signal.SIGTERM)
    else:
        viewer.terminate()
    viewer.communicate()


def _wait(viewer: subprocess.Popen[bytes]) -> None:
    """Wait until the user presses Ctrl-C or ends this process."""
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        viewer.wait()
    except KeyboardInterrupt:
        return
    finally:
        signal.signal(signal.SIGTERM, before)
    raise BadInput(_complaint(viewer))


def _wait_for(port: int, viewer: subprocess.Popen[bytes]) -> None:
    """Wait until a process listens on a port."""
    end_s = time.monotonic() + _START_S
    while time.monotonic() < end_s and viewer.poll() is None:
        with socket.socket() as probe:
            if probe.connect_ex((LOOPBACK, port)) == 0:
                return
        time.sleep(_POLL_S)
    raise BadInput(_complaint(viewer))


def _complaint(viewer: subprocess.Popen[bytes]) -> str:
    """Return the last line of rerun's output."""
    if viewer.poll() is None or viewer.stderr is None:
        return "rerun's viewer does not start"
    lines = viewer.stderr.read().decode(errors="replace").strip().splitlines()
    return f"rerun's viewer failed: {lines[-1] if lines else f'exit code {viewer.returncode}'}"


def _ports(first: int | None) -> tuple[int, int]:
    """Return a port and the next one if both are free, or any two free ports."""
    wanted = (0, 0) if first is None else (first, first + 1)
    with ExitStack() as held:
        try:
            found = [held.enter_context(socket.create_server((LOOPBACK, port))) for port in wanted]
        except OSError as error:
            raise BadInput(
                f"--port {first}: {wanted[0]} and {wanted[1]} are not both free; leave it out for any two"
            ) from error
        one, other = (each.getsockname()[1] for each in found)
    return one, other


def _source(port: int) -> str:
    return f"rerun+http://{LOOPBACK}:{port}/proxy"
