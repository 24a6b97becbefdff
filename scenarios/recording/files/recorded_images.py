"""Read back from a recording what people were shown of a camera."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from rerun.chunk import RrdReader

from peopleboy.scenarios.recording.entities import camera_path
from peopleboy.scenarios.recording.files.recording_file import is_whole


def recorded_images(recording: Path, camera: str, frames: Collection[int]) -> dict[int, NDArray[np.uint8]]:
    """Read a camera's images, grey or RGB, at some frames (from 1), with what JPEG has lost of them.

    Frames at which there is none are left out; so are all of a file that is not whole or cannot be read.
    """
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
