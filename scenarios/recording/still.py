"""What of a recording never changes: the place, the robot's body, its cameras, and how things look."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np
import rerun as rr
from rerun.components import Colormap, FillMode

from peopleboy.scenarios.drawing.palette import person_colour, track_colour
from peopleboy.scenarios.recording.layout import (
    LAYERS,
    OCCLUSIONS,
    ON_COLOUR,
    ON_FURTHER,
    PLACES,
    TRAILS,
    camera_path,
    person_path,
    points_path,
    thing_path,
)
from peopleboy.scenarios.recording.solids import Solid, fixture_solids, group_fixtures, urdf_solids
from peopleboy.sim.cameras.camera_config import CameraConfig, DepthConfig
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.places.place import Fixture
from peopleboy.sim.robot.robot_body import URDF
from peopleboy.sim.shapes.shapes import UPRIGHT, ShapeKind
from peopleboy.sim.world_config import WorldConfig

JPEG: Final = "image/jpeg"

_ROBOT_CURVES = {
    "curves/motion/speed": (("speed [m/s]", "speed asked for"), ((86, 180, 233), (52, 108, 140))),
    "curves/motion/turn_rate": (("turn rate [rad/s]", "turn rate asked for"), ((230, 159, 0), (138, 95, 0))),
}
_POINT_M = 0.02


class Still:
    """Logs to a stream what holds for the whole recording.

    Args:
        stream: to which.
        packing: media type of the images of cameras, those of depth aside.
    """

    def __init__(self, stream: rr.RecordingStream, packing: str = JPEG) -> None:
        self._stream = stream
        self._packing = packing

    def log_world(self, config: WorldConfig) -> None:
        """Log the place, the robot and who will be there."""
        self._log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
        moved = {mover.name for mover in config.place.movers}
        self._log_moved([f for f in config.place.fixtures if f.name.split("/")[0] in moved])
        still = [f for f in config.place.fixtures if f.name.split("/")[0] not in moved]
        for group, fixtures in group_fixtures(still).items():
            # Whoever looks in from outside looks through the walls.
            fill = FillMode.TransparentFillMajorWireframe if group == "walls" else FillMode.Solid
            self._log_solids(f"world/place/{group}", [s for f in fixtures for s in fixture_solids(f)], fill)
        self._log_solids("world/robot/body", urdf_solids(URDF), FillMode.Solid)
        # The colour camera's picture hangs nearer: it covers the middle of the thermal one.
        on_thermal = tuple(layer for layer in LAYERS if not layer.startswith("explained"))
        own = {"thermal": (on_thermal, 1.4), "colour": (ON_COLOUR, 0.8)}
        for name, camera in config.robot.cameras.items():
            layers, reach_m = own.get(name, (ON_FURTHER, 0.8))
            self._log_camera(camera_path(name), camera, layers, reach_m)
            if isinstance(camera, DepthConfig):
                self._log(points_path(name), rr.Points3D.from_fields(radii=[_POINT_M]))
        self._log(PLACES, rr.Ellipsoids3D.from_fields(fill_mode=FillMode.MajorWireframe))
        self._log(TRAILS, rr.LineStrips3D.from_fields(radii=[0.02]))
        self._log(OCCLUSIONS, rr.Arrows3D.from_fields(radii=[0.03]))
        for curve, (labels, shades) in _ROBOT_CURVES.items():
            self._log(curve, rr.SeriesLines(names=labels, colors=shades))
        self._log_people([person.name for person in config.people])

    def log_track(self, number: int, kinds: Sequence[str] = ("confidence", "offset")) -> None:
        """Name the curves of a track, of some kinds."""
        line = rr.SeriesLines(names=[f"track {number}"], colors=[track_colour(number)])
        for kind in kinds:
            self._log(f"curves/{kind}/track_{number}", line)

    def _log_moved(self, fixtures: Sequence[Fixture]) -> None:
        """Log things that are moved, each in its own frame, which goes with it."""
        own: dict[str, list[Solid]] = {}
        for fixture in fixtures:
            here = replace(fixture, position=(0.0, 0.0, 0.0), orientation=UPRIGHT)
            own.setdefault(fixture.name.split("/")[0], []).extend(fixture_solids(here))
        for name, solids in own.items():
            self._log_solids(thing_path(name), solids, FillMode.Solid)

    def _log_people(self, names: Sequence[str]) -> None:
        colours = [person_colour(number) for number, _ in enumerate(names, start=1)]
        for name, colour in zip(names, colours, strict=True):
            body = rr.Capsules3D.from_fields(colors=[colour], fill_mode=FillMode.Solid, labels=[name])
            self._log(f"{person_path(name)}/body", body)
        self._log("curves/visible", rr.SeriesLines(names=names, colors=colours))

    def _log(self, path: str, *what: Any) -> None:
        self._stream.log(path, *what, static=True, strict=True)

    def _log_solids(self, path: str, solids: Sequence[Solid], fill: FillMode) -> None:
        for kind in sorted({solid.kind for solid in solids}):
            alike = [solid for solid in solids if solid.kind is kind]
            self._log(f"{path}/{kind.name.lower()}", _shape(kind, alike, fill))

    def _log_camera(self, path: str, config: CameraConfig, layers: Sequence[str], reach_m: float) -> None:
        camera = config.camera
        pose = camera.robot_from_camera
        frame = rr.Transform3D(translation=pose[:3, 3], mat3x3=pose[:3, :3])
        self._log(path, frame, *([_pinhole(camera, reach_m)] if isinstance(camera, Pinhole) else []))
        self._log(f"{path}/image", _picture(config, self._packing))
        for layer in layers:
            archetype, radius = LAYERS[layer]
            more = {"show_labels": False} if archetype is rr.Arrows2D else {}
            self._log(f"{path}/{layer}", archetype.from_fields(radii=rr.Radius.ui_points([radius]), **more))


def _picture(config: CameraConfig, packing: str) -> rr.AsComponents:
    """Return how images of a camera are packed, and coloured if they are of depth [mm]."""
    if not isinstance(config, DepthConfig):
        return rr.EncodedImage.from_fields(media_type=packing)
    reach_mm = 1000.0 * np.array([config.nearest_m, config.farthest_m])
    return rr.EncodedDepthImage.from_fields(
        media_type="image/png", meter=1000.0, colormap=Colormap.Turbo, depth_range=reach_mm
    )


def _pinhole(camera: Pinhole, reach_m: float) -> rr.Pinhole:
    """Let the picture of a camera hang so far before it."""
    u, v = camera.centre_px
    return rr.Pinhole(
        focal_length=camera.focal_px,
        principal_point=(u + 0.5, v + 0.5),
        resolution=(camera.width, camera.height),
        camera_xyz=rr.ViewCoordinates.RDF,
        image_plane_distance=reach_m,
    )


def _shape(kind: ShapeKind, solids: Sequence[Solid], fill: FillMode) -> rr.AsComponents:
    """Turn solids of one kind into rerun's."""
    size = np.array([solid.size for solid in solids])
    common: Any = {
        "centers": [solid.position for solid in solids],
        "quaternions": [solid.orientation for solid in solids],
        "colors": [solid.colour for solid in solids],
        "fill_mode": fill,
    }
    if kind is ShapeKind.BOX:
        return rr.Boxes3D(sizes=size, **common)
    if kind is ShapeKind.SPHERE:
        return rr.Ellipsoids3D(radii=size[:, 0], **common)
    return rr.Cylinders3D(lengths=size[:, 0], radii=size[:, 1], **common)
