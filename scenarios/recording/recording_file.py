"""Find, check, pack and read back the recording of a run."""

import importlib.util
import logging
import os
import subprocess
import sys
from collections.abc import Collection
from functools import cache
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.atomic_output import atomic
from peopleboy.scenarios.run_folder.finished_run import runs_in

INSTALL = "pip install 'peopleboy[viewer]'"
MISSING = f"needs rerun: {INSTALL}"

# First bytes of a rerun file, and the last bytes of one that was closed.
_HEAD, _FOOT, _FOOT_BYTES = b"RRF2", b"RRF2FOOT", 12


def is_installed() -> bool:
    """Return whether rerun is installed, without loading it."""
    return importlib.util.find_spec("rerun") is not None


def check_installed(what: str) -> None:
    """Raise an error if rerun is not installed.

    Args:
        what: the option or feature that needs rerun.

    Raises:
        BadInput: rerun is not installed.
    """
    if not is_installed():
        raise BadInput(f"{what}: {MISSING}")


def is_recorded(is_wanted: bool) -> bool:
    """Return whether a recording is requested and rerun is installed; log a notice if it is missing."""
    if is_wanted and not is_installed():
        _note_once(f"no recording is written: {MISSING}")
        return False
    return is_wanted


@cache
def _note_once(notice: str) -> None:
    logging.getLogger(__name__).warning(notice)


def recording_in(folder: Path) -> Path:
    """Find the recording of a run, also of an interrupted one.

    Raises:
        BadInput: the folder is missing, holds no run or several, or no rerun recording.
    """
    inner = runs_in(folder)
    if inner != [folder]:
        raise BadInput(f"{folder}: holds {len(inner)} runs; give one of them, such as {inner[0]}")
    recording = folder / "recording.rrd"
    if not recording.is_file() and not (folder / "run.json").is_file():
        raise BadInput(f"{folder}: holds no run and no recording; give the folder of a run")
    _check(recording)
    return recording


def layers_in(folder: Path) -> list[Path]:
    """List the recordings that overlay that of a run: those of a scene model."""
    return sorted(folder.glob("scene/scene.rrd"))


def is_whole(recording: Path) -> bool:
    """Return whether a recording was closed; an interrupted one opens too, but lacks its end."""
    with recording.open("rb") as file:
        file.seek(-min(_FOOT_BYTES, recording.stat().st_size), os.SEEK_END)
        return _FOOT in file.read()


def _check(recording: Path) -> None:
    if not recording.is_file():
        why = "without --no-recording" if is_installed() else f"after you have installed rerun ({INSTALL})"
        raise BadInput(f"{recording}: no such recording; run the scenario again, {why}")
    try:
        with recording.open("rb") as file:
            is_recording = file.read(len(_HEAD)) == _HEAD
    except OSError as error:
        raise BadInput(f"{recording}: cannot be read: {error.strerror}") from error
    if not is_recording:
        raise BadInput(f"{recording}: not a rerun recording; run the scenario again")


_ONLY_ERRORS = {"RUST_LOG": "error"}


def pack(path: Path) -> None:
    """Merge the chunks of a recording, which were written second by second; this saves a sixth of its size.

    The file is replaced only when the new one is complete, and not at all if rerun's program fails.
    """
    # Rerun's program exits with 0 if it cannot read its input, and then writes no file.
    with atomic(path) as packed:
        command = [sys.executable, "-m", "rerun_cli", "rrd", "optimize", str(path), "--output", str(packed)]
        done = subprocess.run(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            env=os.environ | _ONLY_ERRORS, check=False,
        )  # fmt: skip
        if done.returncode != 0:
            packed.unlink(missing_ok=True)


def recorded_images(recording: Path, camera: str, frames: Collection[int]) -> dict[int, NDArray[np.uint8]]:
    """Read a camera's images, grey or RGB, at some frames (from 1), with JPEG artefacts.

    Frames without an image are omitted, and all frames of a file that is incomplete or unreadable.
    """
    if not is_installed():
        return {}
    from rerun.chunk import RrdReader

    from peopleboy.scenarios.recording.layout import camera_path

    wanted, path = set(frames), f"/{camera_path(camera)}/image"
    found: dict[int, NDArray[np.uint8]] = {}
    try:
        if not is_whole(recording):
            return {}
        for chunk in RrdReader(recording).stream().filter(content=path, is_static=False):
            rows = chunk.to_record_batch()
            for row, frame in enumerate(rows.column("frame").to_pylist()):
                if frame in wanted:
                    found[frame] = _decoded(rows.column("EncodedImage:blob")[row])
    except (ValueError, OSError, RuntimeError, KeyError, cv2.error):
        return {}
    return found


def _decoded(blob: Any) -> NDArray[np.uint8]:
    stored = np.asarray(blob.values[0].values.to_numpy(zero_copy_only=False), np.uint8)
    image = cv2.imdecode(stored, cv2.IMREAD_UNCHANGED)
    if image is None:
        raise ValueError("no image")
    return np.ascontiguousarray(image[..., ::-1] if image.ndim == 3 else image, np.uint8)
