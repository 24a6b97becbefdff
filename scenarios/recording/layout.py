"""Name the entities of a recording, lay out its views, and log its static content.

world/place/...             floor, walls and objects; the ceiling is hidden at first
world/place/moved/NAME      an object that is moved, in its own moving frame
world/robot                 its pose; its children are body and cameras, with the overlays of their images:
world/robot/thermal/...     image, tracks with evidence, particles, truth
world/robot/colour/...      image, tracks, truth
world/robot/CAMERA/...      image, truth, and tracks if they have boxes there, of any further camera
world/robot/CAMERA/explained  the tracker's explanation of that image: background, and lines
world/points/CAMERA         point cloud of a depth camera, in colour
world/robot/places          the tracks' positions on the floor, with 95 % ellipses
world/people/NAME/body      capsules, and the name
world/occlusions            arrows from the occluder to the occluded person
world/trails                paths of robot and people
curves/..., events          content of the lower row of views
"""

import math
from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from rerun.components import Colormap, FillMode

from peopleboy.scenarios.drawing.palette import person_colour, track_colour
from peopleboy.scenarios.recording.solids import Solid, fixture_solids, group_fixtures, urdf_solids
from peopleboy.sim.cameras.camera_config import CameraConfig, DepthConfig, LaserConfig
from peopleboy.sim.geometry.panorama import Panorama
from peopleboy.sim.geometry.pinhole import CameraGeometry, Pinhole
from peopleboy.sim.geometry.scan_plane import ScanPlane
from peopleboy.sim.places.place import Fixture
from peopleboy.sim.robot.robot_body import URDF
from peopleboy.sim.shapes.shapes import UPRIGHT, ShapeKind
from peopleboy.sim.world_config import WorldConfig

THERMAL: Final = "world/robot/thermal"
COLOUR: Final = "world/robot/colour"
OCCLUSIONS: Final = "world/occlusions"
PLACES: Final = "world/robot/places"
TRAILS: Final = "world/trails"
EVENTS: Final = "events"

# Archetype of each layer on an image, and its radius in points of the screen.
LAYERS: Final[dict[str, tuple[Any, float]]] = {
    "truth/boxes": (rr.Boxes2D, 0.6),
    "truth/names": (rr.Points2D, 0.0),
    "truth/occlusions": (rr.Arrows2D, 1.2),
    "tracks/boxes": (rr.Boxes2D, 1.0),
    "tracks/contours": (rr.LineStrips2D, 1.8),
    "tracks/occlusions": (rr.Arrows2D, 1.2),
    "explained/lines": (rr.LineStrips2D, 0.8),
    "particles/people": (rr.Points2D, 1.5),
    "particles/detector": (rr.Points2D, 1.5),
}
ON_COLOUR: Final = ("truth/boxes", "truth/names", "tracks/boxes")
ON_FURTHER: Final = ("truth/boxes", "truth/names", "tracks/boxes", "explained/lines")
BACKGROUND: Final = "explained/background"


def camera_path(name: str) -> str:
    """Return the entity of a camera."""
    return f"world/robot/{name}"


def points_path(camera: str) -> str:
    """Return the entity of a depth camera's point cloud, or of a range finder's scan."""
    return f"world/points/{camera}"


def thing_path(name: str) -> str:
    """Return the entity of an object that is moved."""
    return f"world/place/moved/{rr.escape_entity_path_part(name)}"


def person_path(name: str) -> str:
    """Return the entity of a person."""
    return f"world/people/{rr.escape_entity_path_part(name)}"


def lay_out(
    config: WorldConfig, watched: Collection[str] = (), *, attends: bool = False, follows: bool = False
) -> rrb.Blueprint:
    """Lay out thermal on the left, then colour, events, further cameras and the world; curves below.

    Args:
        config: configuration of the world.
        watched: cameras that the tracker uses.
        attends: whether the tracker explains its search for a person in colour images.
        follows: whether the viewer follows the newest frame; else it opens at the first one.
    """
    cameras = {name: camera.camera for name, camera in config.robot.cameras.items()}
    thermal = _image_view(THERMAL, "Thermal: tracks with evidence, particles, truth", cameras.pop("thermal"))
    colour = _colour_view(cameras.pop("colour"), attends=attends)
    further = [
        _further_view(name, camera, name in watched)
        for name, camera in cameras.items()
        if not isinstance(camera, ScanPlane)  # whose points are in the world
    ]
    events = rrb.TextLogView(
        origin=EVENTS, name="Events", columns=rrb.TextLogColumns(text_log_columns=["LogLevel", "Body"])
    )
    plots = [
        _plot("confidence", "Confidence of tracks", (-0.05, 1.05), has_legend=False),
        _plot("visible", "Visible fraction of people", (-0.05, 1.05)),
        _plot("offset", "Offset of tracks [half widths]", (-1.05, 1.05), has_legend=False),
        _plot("motion", "Speed and turn rate", (-1.6, 1.6)),
    ]
    if attends:
        plots.insert(1, _plot("likeness", "Similarity to learned person", (-0.05, 1.05), has_legend=False))
    rows = [rrb.Horizontal(colour, events), *([rrb.Horizontal(*further)] if further else [])]
    right = rrb.Vertical(*rows, _world_view(config))
    above = rrb.Horizontal(thermal, right, column_shares=[1.0, 1.0])
    return rrb.Blueprint(
        rrb.Vertical(above, rrb.Horizontal(*plots), row_shares=[3.0, 1.0]),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline="time", play_state="following" if follows else "paused"),
    )


def _colour_view(camera: CameraGeometry, *, attends: bool) -> rrb.Spatial2DView | rrb.Tabs:
    """Show the colour camera, and in a second tab the attention score of each place."""
    if not attends:
        return _image_view(COLOUR, "Colour: tracks, truth", camera)
    return rrb.Tabs(
        _image_view(
            COLOUR, "Colour: tracks, focus, truth", camera, ("$origin/**", f"- $origin/{BACKGROUND}")
        ),
        _image_view(COLOUR, "Colour: attention, focus", camera, ("$origin/explained/**",)),
        active_tab=0,
    )


def _further_view(name: str, camera: CameraGeometry, is_watched: bool) -> rrb.Spatial2DView | rrb.Tabs:
    """Show a further camera; for a panorama that the tracker uses, the background in a second tab."""
    path, words = camera_path(name), name.capitalize()
    contents = ("$origin/**", f"- $origin/{BACKGROUND}")
    if not is_watched:
        return _image_view(path, f"{words}: truth", camera, contents)
    if not isinstance(camera, Panorama):
        return _image_view(path, f"{words}: tracks, truth", camera, contents)
    return rrb.Tabs(
        _image_view(path, f"{words}: tracks with evidence, truth", camera, contents),
        _image_view(path, f"{words}: background, evidence", camera, ("$origin/explained/**",)),
        active_tab=0,
    )


def _image_view(
    path: str, name: str, camera: CameraGeometry, contents: Sequence[str] = ("$origin/**",)
) -> rrb.Spatial2DView:
    bounds = rrb.VisualBounds2D(x_range=(0.0, camera.width), y_range=(0.0, camera.height))
    return rrb.Spatial2DView(origin=path, contents=list(contents), name=name, visual_bounds=bounds)


def _world_view(config: WorldConfig) -> rrb.Spatial3DView:
    """Show the whole place from behind the robot; trails are shown from the start up to the current time."""
    min_x, min_y, max_x, max_y = config.place.bounds
    x, y, size = (min_x + max_x) / 2, (min_y + max_y) / 2, max(max_x - min_x, max_y - min_y)
    ahead, left = math.cos(config.robot.heading_rad), math.sin(config.robot.heading_rad)
    back, aside, up = 0.55 * size, 0.35 * size, 0.45 * size
    start, now = rr.TimeRangeBoundary.infinite(), rr.TimeRangeBoundary.cursor_relative()
    so_far = rrb.VisibleTimeRanges(
        [rr.VisibleTimeRange(timeline, start=start, end=now) for timeline in ("frame", "time")]
    )
    # Boxes of people close to the camera extend far beyond the image, and would cross the whole world.
    cameras = config.robot.cameras
    layers = (*LAYERS, BACKGROUND)
    overlays = [f"- {path}/{layer}" for path in map(camera_path, cameras) for layer in layers]
    # A panorama is not planar, so it has no image plane in the world.
    overlays += [
        f"- {camera_path(name)}/image"
        for name, camera in cameras.items()
        if not isinstance(camera.camera, Pinhole)
    ]
    # The point cloud of a depth image is logged separately, in its own colours.
    overlays += [
        f"- {camera_path(name)}/image" for name, camera in cameras.items() if isinstance(camera, DepthConfig)
    ]
    return rrb.Spatial3DView(
        origin="world",
        contents=["$origin/**", "- $origin/place/ceiling/**", *overlays],
        name="World",
        overrides={TRAILS: so_far},
        eye_controls=rrb.EyeControls3D(
            position=(x - back * ahead + aside * left, y - back * left - aside * ahead, up),
            look_target=(x, y, 0.0),
            eye_up=(0.0, 0.0, 1.0),
        ),
    )


def _plot(kind: str, name: str, span: tuple[float, float], *, has_legend: bool = True) -> rrb.TimeSeriesView:
    """Plot curves; those of tracks have the tracks' colours, and need no legend."""
    return rrb.TimeSeriesView(
        origin=f"curves/{kind}",
        name=name,
        axis_y=rrb.ScalarAxis(range=span),
        plot_legend=rrb.PlotLegend(visible=has_legend),
    )


JPEG: Final = "image/jpeg"

_ROBOT_CURVES = {
    "curves/motion/speed": (("speed [m/s]", "commanded speed"), ((86, 180, 233), (52, 108, 140))),
    "curves/motion/turn_rate": (("turn rate [rad/s]", "commanded turn rate"), ((230, 159, 0), (138, 95, 0))),
}
_POINT_M = 0.02


class Still:
    """Logs the static content of a recording.

    Args:
        stream: the recording stream.
        packing: media type of camera images, except depth images.
    """

    def __init__(self, stream: rr.RecordingStream, packing: str = JPEG) -> None:
        self._stream = stream
        self._packing = packing

    def log_world(self, config: WorldConfig) -> None:
        """Log the place, the robot and the people."""
        self._log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
        moved = {mover.name for mover in config.place.movers}
        self._log_moved([f for f in config.place.fixtures if f.name.split("/")[0] in moved])
        still = [f for f in config.place.fixtures if f.name.split("/")[0] not in moved]
        for group, fixtures in group_fixtures(still).items():
            # Walls must not block the view from outside.
            fill = FillMode.TransparentFillMajorWireframe if group == "walls" else FillMode.Solid
            self._log_solids(f"world/place/{group}", [s for f in fixtures for s in fixture_solids(f)], fill)
        self._log_solids("world/robot/body", urdf_solids(URDF), FillMode.Solid)
        # The image plane of the colour camera is nearer: it covers the middle of the thermal one.
        on_thermal = tuple(layer for layer in LAYERS if not layer.startswith("explained"))
        own = {"thermal": (on_thermal, 1.4), "colour": (ON_COLOUR, 0.8)}
        for name, camera in config.robot.cameras.items():
            layers, reach_m = own.get(name, (ON_FURTHER, 0.8))
            self._log_camera(camera_path(name), camera, layers, reach_m)
            if isinstance(camera, DepthConfig | LaserConfig):
                self._log(points_path(name), rr.Points3D.from_fields(radii=[_POINT_M]))
        self._log(PLACES, rr.Ellipsoids3D.from_fields(fill_mode=FillMode.MajorWireframe))
        self._log(TRAILS, rr.LineStrips3D.from_fields(radii=[0.02]))
        self._log(OCCLUSIONS, rr.Arrows3D.from_fields(radii=[0.03]))
        for curve, (labels, shades) in _ROBOT_CURVES.items():
            self._log(curve, rr.SeriesLines(names=labels, colors=shades))
        self._log_people([person.name for person in config.people])

    def log_track(self, number: int, kinds: Sequence[str] = ("confidence", "offset")) -> None:
        """Log the names and colours of a track's curves, by kind."""
        line = rr.SeriesLines(names=[f"track {number}"], colors=[track_colour(number)])
        for kind in kinds:
            self._log(f"curves/{kind}/track_{number}", line)

    def _log_moved(self, fixtures: Sequence[Fixture]) -> None:
        """Log objects that are moved, each in its own moving frame."""
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
    """Return the encoding of a camera's images, and the colour map of depth images [mm]."""
    if not isinstance(config, DepthConfig):
        return rr.EncodedImage.from_fields(media_type=packing)
    reach_mm = 1000.0 * np.array([config.nearest_m, config.farthest_m])
    return rr.EncodedDepthImage.from_fields(
        media_type="image/png", meter=1000.0, colormap=Colormap.Turbo, depth_range=reach_mm
    )


def _pinhole(camera: Pinhole, reach_m: float) -> rr.Pinhole:
    """Set the distance of a camera's image plane."""
    u, v = camera.centre_px
    return rr.Pinhole(
        focal_length=camera.focal_px,
        principal_point=(u + 0.5, v + 0.5),
        resolution=(camera.width, camera.height),
        camera_xyz=rr.ViewCoordinates.RDF,
        image_plane_distance=reach_m,
    )


def _shape(kind: ShapeKind, solids: Sequence[Solid], fill: FillMode) -> rr.AsComponents:
    """Convert solids of one kind to a rerun archetype."""
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
