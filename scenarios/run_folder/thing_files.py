"""What was true of things in a run: truth/things.parquet, and the backgrounds behind what comes and goes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Final

import pyarrow as pa

from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.run_folder.image_files import millimetres, write_png
from peopleboy.scenarios.run_folder.tables import Row, write_table
from peopleboy.sim.cameras.camera_config import CameraConfig, DepthConfig
from peopleboy.sim.truth.backgrounds import Backgrounds
from peopleboy.sim.truth.truth import ThingTruth

_EDGES = ("left_px", "top_px", "width_px", "height_px")

THINGS: Final = pa.schema(
    [
        pa.field("frame", pa.int64()),
        pa.field("time_s", pa.float64()),
        pa.field("name", pa.string()),
        *(pa.field(name, pa.float64()) for name in ("x_m", "y_m", "z_m", "heading_rad")),
        pa.field("is_there", pa.bool_()),
        pa.field("is_moving", pa.bool_()),
        pa.field("moved_by", pa.string()),
        pa.field("visible_px", pa.int64()),
        *(pa.field(name, pa.float64()) for name in _EDGES),
    ]
)


def things_camera(cameras: Mapping[str, CameraConfig]) -> str:
    """Name the camera in whose image things are told: the first depth camera, else `thermal`."""
    return next(iter(depth_cameras(cameras)), "thermal")


def depth_cameras(cameras: Mapping[str, CameraConfig]) -> tuple[str, ...]:
    """Name the cameras that measure depth."""
    return tuple(name for name, config in cameras.items() if isinstance(config, DepthConfig))


class ThingFiles:
    """Writes the truth about things, of a run in which some are moved.

    Args:
        folder: truth/ of the run.
        cameras: of the robot.
        frames: whether images are written, and with them the backgrounds of depth cameras.
    """

    def __init__(self, folder: Path, cameras: Mapping[str, CameraConfig], *, frames: bool) -> None:
        self._folder = folder
        self._camera = things_camera(cameras)
        self._rows: list[Row] = []
        self._is_told = False
        self._backgrounds = {name: Backgrounds() for name in depth_cameras(cameras)} if frames else {}

    def write(self, tick: Tick) -> None:
        """Take in what is true at one tick."""
        if tick.truth.things and self._camera in tick.truths:
            self._is_told = True
            self._rows += [_row(tick, thing) for thing in tick.truths[self._camera].things]
        for name, backgrounds in self._backgrounds.items():
            if name in tick.truths:
                backgrounds.update(tick.truths[name])

    def flush(self) -> None:
        """Bring everything to disk."""
        if self._is_told:
            write_table(self._folder / "things.parquet", self._rows, THINGS)
        for name, backgrounds in self._backgrounds.items():
            for kind, depth in (("clean", backgrounds.clean), ("ever", backgrounds.ever)):
                if depth is not None:
                    write_png(self._folder / f"{name}_{kind}.png", millimetres(depth))


def _row(tick: Tick, thing: ThingTruth) -> Row:
    x, y, z = thing.position_m
    box = (None,) * 4 if thing.visible_box is None else thing.visible_box
    return {
        "frame": tick.frame,
        "time_s": tick.truth.time_s,
        "name": thing.name,
        "x_m": x,
        "y_m": y,
        "z_m": z,
        "heading_rad": thing.heading_rad,
        "is_there": thing.is_there,
        "is_moving": thing.is_moving,
        "moved_by": thing.moved_by,
        "visible_px": thing.visible_px,
        **dict(zip(_EDGES, box, strict=True)),
    }
