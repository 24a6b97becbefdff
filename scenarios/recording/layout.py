"""Name the entities of a recording, and lay out its views.

world/place/...             floor, walls and things; the ceiling is there, but not shown at first
world/place/moved/NAME      a thing that is moved, in a frame that goes with it
world/robot                 its pose; below it body and cameras, with what is drawn on their images:
world/robot/thermal/...     image, tracks with evidence, particles, truth
world/robot/colour/...      image, tracks, truth
world/robot/CAMERA/...      image, truth, and tracks if they have boxes there, of any further camera
world/robot/CAMERA/explained  what the tracker explains of that image: the empty scene, and lines
world/points/CAMERA         what a depth camera sees, as points with their colours
world/robot/places          where on the floor the tracker takes people to be, with 95 % ellipses
world/people/NAME/body      capsules, and the name
world/occlusions            arrows from who hides to who is hidden
world/trails                where robot and people went
curves/..., events          what the lower row of views shows
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from typing import Any, Final

import rerun as rr
import rerun.blueprint as rrb

from peopleboy.sim.cameras.camera_config import DepthConfig
from peopleboy.sim.geometry.panorama import Panorama
from peopleboy.sim.geometry.pinhole import CameraGeometry, Pinhole
from peopleboy.sim.world_config import WorldConfig

THERMAL: Final = "world/robot/thermal"
COLOUR: Final = "world/robot/colour"
OCCLUSIONS: Final = "world/occlusions"
PLACES: Final = "world/robot/places"
TRAILS: Final = "world/trails"
EVENTS: Final = "events"

# What a layer on an image is made of, and its radius in points of the screen.
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
    """Return the entity of the points that a depth camera sees."""
    return f"world/points/{camera}"


def thing_path(name: str) -> str:
    """A thing that is moved."""
    return f"world/place/moved/{rr.escape_entity_path_part(name)}"


def person_path(name: str) -> str:
    """Return the entity of a person."""
    return f"world/people/{rr.escape_entity_path_part(name)}"


def lay_out(
    config: WorldConfig, watched: Collection[str] = (), *, attends: bool = False, follows: bool = False
) -> rrb.Blueprint:
    """Lay out: thermal on the left, colour, events, further cameras and the world beside it, curves below.

    Args:
        config: of the world.
        watched: cameras that the tracker asks for.
        attends: whether it explains where in colour images it looks for a person.
        follows: whether the newest frame is shown as it comes; else it stands at the first one when opened.
    """
    cameras = {name: camera.camera for name, camera in config.robot.cameras.items()}
    thermal = _image_view(THERMAL, "Thermal: tracks with evidence, particles, truth", cameras.pop("thermal"))
    colour = _colour_view(cameras.pop("colour"), attends=attends)
    further = [_further_view(name, camera, name in watched) for name, camera in cameras.items()]
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
        plots.insert(1, _plot("likeness", "Likeness to who they are", (-0.05, 1.05), has_legend=False))
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
    """Show the colour camera; behind a tab, how much each place looks like the one on whom attention is."""
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
    """Show a further camera; of a panorama that is watched, behind a tab, what it is compared with."""
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
    """Look over the robot's right shoulder at the whole place; trails are shown from the start up to now."""
    min_x, min_y, max_x, max_y = config.place.bounds
    x, y, size = (min_x + max_x) / 2, (min_y + max_y) / 2, max(max_x - min_x, max_y - min_y)
    ahead, left = math.cos(config.robot.heading_rad), math.sin(config.robot.heading_rad)
    back, aside, up = 0.55 * size, 0.35 * size, 0.45 * size
    start, now = rr.TimeRangeBoundary.infinite(), rr.TimeRangeBoundary.cursor_relative()
    so_far = rrb.VisibleTimeRanges(
        [rr.VisibleTimeRange(timeline, start=start, end=now) for timeline in ("frame", "time")]
    )
    # Boxes of people who are near reach far out of the image, and would cross the whole world.
    cameras = config.robot.cameras
    layers = (*LAYERS, BACKGROUND)
    overlays = [f"- {path}/{layer}" for path in map(camera_path, cameras) for layer in layers]
    # Where a picture that is not flat would hang, nobody can say.
    overlays += [
        f"- {camera_path(name)}/image"
        for name, camera in cameras.items()
        if not isinstance(camera.camera, Pinhole)
    ]
    # The points of a depth image are there by themselves, in their own colours.
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
    """Plot curves; those of tracks have the colours of the tracks on the images, and need no legend."""
    return rrb.TimeSeriesView(
        origin=f"curves/{kind}",
        name=name,
        axis_y=rrb.ScalarAxis(range=span),
        plot_legend=rrb.PlotLegend(visible=has_legend),
    )
