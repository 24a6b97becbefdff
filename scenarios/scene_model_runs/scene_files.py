"""What a scene model leaves: a line a frame, and a map of what stands."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from peopleboy.scenarios.run_folder.image_files import write_png
from peopleboy.tracker.scene_model.scene import Metres, VistaScene
from peopleboy.tracker.scene_model.vista_spaces import Surface

LINES, MAP, BACKGROUND, RECORDING = "scene.jsonl", "static_map.ply", "background.png", "scene.rrd"
"""The files, in the folder of one look at a run."""

_DIGITS = 3


def scene_line(scene: VistaScene) -> str:
    """Give a frame as a line of JSON: time, who and what is there, and what happened."""
    told = {
        "time_s": scene.time_s,
        "vista": scene.vista,
        "is_frozen": scene.is_frozen,
        "persons": [asdict(one) for one in scene.persons],
        "objects": [asdict(one) for one in scene.objects],
        "happenings": [asdict(one) for one in scene.happenings],
    }
    return json.dumps(_rounded(told)) + "\n"


def write_map(surface: Surface, path: Path) -> None:
    """Write points and normals as a binary PLY file, in the frame of the robot's first place [m].

    Normals point back to the camera, as viewers and registration expect them.
    """
    names = ("x", "y", "z", "nx", "ny", "nz")
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(surface.points_m)}"]
    head += [*(f"property float {name}" for name in names), "end_header", ""]
    rows = np.concatenate([surface.points_m, -surface.normals], axis=1).astype("<f4")
    path.write_bytes("\n".join(head).encode() + rows.tobytes())


def write_background(depth_m: Metres, path: Path) -> None:
    """Write (H, W) depths [m] as a 16-bit image in millimetres; 0 where nothing is known."""
    write_png(path, np.rint(1000.0 * np.minimum(depth_m, 65.0)).astype(np.uint16))


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return round(value, _DIGITS)
    if isinstance(value, dict):
        return {key: _rounded(one) for key, one in value.items()}
    return [_rounded(one) for one in value] if isinstance(value, list | tuple) else value
