"""Small runs to export: one person goes behind a pillar, one comes too near to count, the robot drives."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from tests.helpers.calls.command_line import run_cli

CAMERAS = {"thermal": {"kind": "thermal", "width_px": 160, "height_px": 120}}
SCENE: dict[str, Any] = {
    "name": "tiny",
    "description": "Two people cross, one of them close to the robot.",
    "duration_s": 4.0,
    "place": {"kind": "room", "length_m": 8.0, "width_m": 6.0},
    "things": [{"kind": "pillar", "at_m": [4.6, 0.3], "size_m": [0.4, 0.9, 2.7]}],
    "people": [
        {"name": "anna", "path": [{"at_m": [5.5, -1.4]}, {"at_m": [5.5, 2.4], "speed_m_s": 1.2}]},
        {"name": "ben", "path": [{"at_m": [3.9, 1.2]}, {"at_m": [3.2, -2.4], "speed_m_s": 1.2}]},
    ],
    "robot": {
        "at_m": [0.6, 0.0],
        "cameras": CAMERAS,
        "behaviour": "scripted",
        "commands": [{"from_s": 0.0, "linear_m_s": 0.1, "angular_deg_s": 5.0}],
    },
}
FOLLOWING: dict[str, Any] = SCENE | {
    "name": "tiny_following",
    "duration_s": 5.0,
    "things": [],
    "people": [{"name": "anna", "path": [{"at_m": [4.0, 0.2]}, {"at_m": [7.0, 0.2], "speed_m_s": 0.7}]}],
    "robot": {"at_m": [0.6, 0.0], "cameras": CAMERAS, "behaviour": "follow_person"},
    "faults": [{"kind": "camera_frozen", "from_s": 3.5}],
}


def make_run(scene: dict[str, Any], folder: Path, *options: object) -> Path:
    """Run a scene; the folder is made."""
    path = folder.parent / f"{scene['name']}.yaml"
    path.write_text(yaml.safe_dump(scene), encoding="utf-8")
    assert run_cli("run", path, "--out", folder, "--no-recording", *options) == 0
    return folder


def export(run: Path, form: str, out: Path) -> Path:
    assert run_cli("export", run, "--format", form, "--out", out) == 0
    return out
