"""The recording of a run: where it lies, and whether it is whole."""

from __future__ import annotations

import os
from pathlib import Path

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.finished_run import runs_in

# What a file of rerun's begins with, and what ends one that was closed.
_HEAD, _FOOT, _FOOT_BYTES = b"RRF2", b"RRF2FOOT", 12


def recording_in(folder: Path) -> Path:
    """Find the recording of a run, of one that was cut off too.

    Raises:
        BadInput: there is no such folder, it holds no run or several, or no recording of rerun's.
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
    """List what lies over the recording of a run: what a scene model believes."""
    return sorted(folder.glob("scene/scene.rrd"))


def is_whole(recording: Path) -> bool:
    """Tell whether a recording was closed; one that was cut off opens too, and lacks its end."""
    with recording.open("rb") as file:
        file.seek(-min(_FOOT_BYTES, recording.stat().st_size), os.SEEK_END)
        return _FOOT in file.read()


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
