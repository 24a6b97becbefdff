"""Write a run as a rerun recording: images with tracks and truth, the world in 3-D, curves and the event log.

Entities:
    world/place/...             floor, walls and things; the ceiling is there, but not shown at first
    world/robot                 its pose; below it body and cameras, with what is drawn on their images:
    world/robot/thermal/...     image, tracks, particles, truth
    world/robot/colour/...      image, tracks, truth
    world/people/NAME/...       body and skeleton
    world/trails/...            where robot and people went
    curves/..., events          what the lower row of views shows
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray
from rerun.components import FillMode

from bad_input import BadInput
from scenarios import marks
from scenarios.figures import NOBODY, body_capsules, stick_figure
from scenarios.loop import Tick
from scenarios.overlay import encode_jpeg
from scenarios.palette import person_colour, track_colour
from scenarios.rows import Rows
from scenarios.run_events import LogLine
from scenarios.solids import Solid, fixture_solids, group_fixtures, urdf_solids
from scenarios.wording import describe
from sim.alignment import affine_between
from sim.camera import Camera, Matrix
from sim.config import WorldConfig
from sim.robot.peoplebot import URDF, Planar
from sim.shapes import ShapeKind
from tracker.config import ContourConfig
from tracker.track import Track

APPLICATION = "peopleboy"

# A track has no depth: its box is mapped to the colour image as if the person were so far away.
TYPICAL_DEPTH_M = 4.0

_FRAMES_SENT_TOGETHER = 30
_NAME_HEIGHT_PX = 16.0
_THERMAL, _COLOUR = "world/robot/thermal", "world/robot/colour"
_LAYERS: dict[str, tuple[Any, float]] = {  # and the radius of what is drawn there, in points of the screen
    "tracks/boxes": (rr.Boxes2D, 1.0),
    "tracks/contours": (rr.LineStrips2D, 1.5),
    "particles/people": (rr.Points2D, 1.5),
    "particles/detector": (rr.Points2D, 1.5),
    "truth/boxes": (rr.Boxes2D, 0.6),
    "truth/names": (rr.Points2D, 0.0),
}
_ROBOT_CURVES = {
    "curves/motion/speed": (("speed [m/s]", "speed asked for"), ((86, 180, 233), (52, 108, 140))),
    "curves/motion/turn_rate": (("turn rate [rad/s]", "turn rate asked for"), ((230, 159, 0), (138, 95, 0))),
}


class Recorder:
    """Writes one recording as the run goes; use it as a context manager.

    Every 30 frames everything since the last time goes to the file, so that a run that is killed leaves a
    file that opens and lacks those frames at most.

    Args:
        path: the file to write.
        config: the world that is recorded.
        title: name of the recording; the same title gives the same recording id.
        contour: proportions of the outlines to draw; the default ones if None.
    """

    def __init__(
        self, path: Path, config: WorldConfig, *, title: str, contour: ContourConfig | None = None
    ) -> None:
        self._contour = ContourConfig() if contour is None else contour
        self._thermal, self._colour = config.robot.thermal.camera, config.robot.colour.camera
        self._affine_at = partial(affine_between, self._thermal, self._colour)
        self._names = [person.name for person in config.people]
        self._trails = marks.Trails()
        self._tracks_named: set[int] = set()
        self._rows = Rows()
        self._stream = rr.RecordingStream(
            APPLICATION, recording_id=title.replace(", ", "-").replace(" ", "-")
        )
        self._stream.save(path, default_blueprint=_blueprint(config))
        self._stream.send_recording_name(title)
        self._log_static(config)

    def __enter__(self) -> Recorder:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def log(self, tick: Tick, events: Sequence[LogLine]) -> None:
        """Add one tick and what happened at it."""
        self._rows.begin(tick.frame, tick.observation.time_s)
        self._log_images(tick)
        self._log_tracks(tick.tracks)
        self._log_particles(tick)
        self._log_truth(tick)
        self._log_world(tick)
        self._log_curves(tick)
        for line in events:
            level = "WARN" if line.kind.startswith(("contact", "lost")) else "INFO"
            self._rows.add("events", rr.TextLog, text=[describe(line)], level=[level])
        if self._rows.frames >= _FRAMES_SENT_TOGETHER:
            self._send()

    def close(self) -> None:
        """Write what is left, and close the file."""
        self._send()
        self._stream.disconnect()

    def _send(self) -> None:
        for rows in self._rows.take():
            frames = rr.TimeColumn("frame", sequence=rows.frames)
            times = rr.TimeColumn("time", duration=np.array(rows.times_s))
            columns = rows.kind.columns(**rows.columns).partition(rows.lengths)
            self._stream.send_columns(rows.path, [frames, times], columns, strict=True)

    def _log_static(self, config: WorldConfig) -> None:
        self._log_once("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
        for group, fixtures in group_fixtures(config.place.fixtures).items():
            # Whoever looks in from outside looks through the walls.
            fill = FillMode.TransparentFillMajorWireframe if group == "walls" else FillMode.Solid
            self._log_solids(f"world/place/{group}", [s for f in fixtures for s in fixture_solids(f)], fill)
        self._log_solids("world/robot/body", urdf_solids(URDF), FillMode.Solid)
        # The colour camera's picture hangs nearer: it covers the middle of the thermal one.
        self._log_camera(_THERMAL, self._thermal, reach_m=1.0)
        self._log_camera(_COLOUR, self._colour, reach_m=0.6)
        for number, name in enumerate(self._names, start=1):
            path, colour = f"world/people/{rr.escape_entity_path_part(name)}", person_colour(number)
            self._log_once(
                f"{path}/body", rr.Capsules3D.from_fields(colors=[colour], fill_mode=FillMode.Solid)
            )
            skeleton = rr.LineStrips3D.from_fields(colors=[(255, 255, 255)], radii=[0.012], labels=[name])
            self._log_once(f"{path}/skeleton", skeleton)
        self._log_once("world/trails", rr.LineStrips3D.from_fields(radii=[0.02]))
        colours = [person_colour(number) for number, _ in enumerate(self._names, start=1)]
        self._log_once("curves/visible", rr.SeriesLines(names=self._names, colors=colours))
        for curve, (labels, shades) in _ROBOT_CURVES.items():
            self._log_once(curve, rr.SeriesLines(names=labels, colors=shades))

    def _log_once(self, path: str, *what: Any) -> None:
        self._stream.log(path, *what, static=True, strict=True)

    def _log_solids(self, path: str, solids: Sequence[Solid], fill: FillMode) -> None:
        for kind in sorted({solid.kind for solid in solids}):
            alike = [solid for solid in solids if solid.kind is kind]
            self._log_once(f"{path}/{kind.name.lower()}", _shape(kind, alike, fill))

    def _log_camera(self, path: str, camera: Camera, reach_m: float) -> None:
        """Log what of a camera and its layers never changes."""
        pose, (u, v) = camera.robot_from_camera, camera.centre_px
        pinhole = rr.Pinhole(
            focal_length=camera.focal_px,
            principal_point=(u + 0.5, v + 0.5),
            resolution=(camera.width, camera.height),
            camera_xyz=rr.ViewCoordinates.RDF,
            image_plane_distance=reach_m,
        )
        self._log_once(path, rr.Transform3D(translation=pose[:3, 3], mat3x3=pose[:3, :3]), pinhole)
        self._log_once(f"{path}/image", rr.EncodedImage.from_fields(media_type="image/jpeg"))
        for layer, (archetype, radius) in _LAYERS.items():
            self._log_once(f"{path}/{layer}", archetype.from_fields(radii=rr.Radius.ui_points([radius])))

    def _log_images(self, tick: Tick) -> None:
        senses = tick.observation
        for path, image, quality in ((_THERMAL, senses.thermal, 80), (_COLOUR, senses.colour, 65)):
            self._rows.add(f"{path}/image", rr.EncodedImage, blob=[encode_jpeg(image, quality)])

    def _log_tracks(self, tracks: Sequence[Track]) -> None:
        contours = marks.track_contours(tracks, self._contour)
        lines = [_from_corner(line) for line in contours.line]
        self._rows.add(f"{_THERMAL}/tracks/contours", rr.LineStrips2D, strips=lines, colors=contours.colour)
        on_thermal = marks.track_boxes(tracks)
        on_colour = marks.track_boxes(tracks, self._affine_at(TYPICAL_DEPTH_M))
        for path, boxes in ((_THERMAL, on_thermal), (_COLOUR, on_colour)):
            self._log_boxes(f"{path}/tracks/boxes", boxes, labels=boxes.label)

    def _log_particles(self, tick: Tick) -> None:
        people = {number: cloud for number, cloud in tick.particles.items() if number > 0}
        detector = {number: cloud for number, cloud in tick.particles.items() if number == 0}
        for name, clouds in (("people", people), ("detector", detector)):
            points = marks.particle_points(clouds)
            place, colour = _from_corner(points.place), points.colour
            self._rows.add(f"{_THERMAL}/particles/{name}", rr.Points2D, positions=place, colors=colour)

    def _log_truth(self, tick: Tick) -> None:
        on_thermal = marks.truth_boxes(tick.truth.people)
        on_colour = marks.truth_boxes(tick.truth.people, lambda away_m: self._affine_at(max(away_m, 0.3)))
        for path, boxes in ((_THERMAL, on_thermal), (_COLOUR, on_colour)):
            self._log_boxes(f"{path}/truth/boxes", boxes)
            above = _from_corner(boxes.box[:, :2]) + boxes.box[:, 2:] * (0.5, 0.0) - (0.0, _NAME_HEIGHT_PX)
            self._rows.add(
                f"{path}/truth/names", rr.Points2D, positions=above, colors=boxes.colour, labels=boxes.label
            )

    def _log_boxes(self, path: str, boxes: marks.Boxes, **labels: list[str]) -> None:
        half = boxes.box[:, 2:] / 2.0
        centre = _from_corner(boxes.box[:, :2]) + half
        self._rows.add(path, rr.Boxes2D, centers=centre, half_sizes=half, colors=boxes.colour, **labels)

    def _log_world(self, tick: Tick) -> None:
        self._rows.add("world/robot", rr.Transform3D, **_planar(tick.truth.robot))
        trails = self._trails.update(tick)
        self._rows.add("world/trails", rr.LineStrips3D, strips=trails.line, colors=trails.colour)
        joints = {person.name: person.joints_m for person in tick.truth.people}
        for name in self._names:
            self._log_person(f"world/people/{rr.escape_entity_path_part(name)}", joints.get(name))

    def _log_person(self, path: str, joints: Matrix | None) -> None:
        lines = [] if joints is None else [np.float32(line) for line in stick_figure(joints)]
        body = NOBODY if joints is None else body_capsules(joints)
        self._rows.add(f"{path}/skeleton", rr.LineStrips3D, strips=lines)
        self._rows.add(
            f"{path}/body", rr.Capsules3D, translations=body.start, quaternions=body.quaternion,
            lengths=body.length, radii=body.radius,
        )  # fmt: skip

    def _log_curves(self, tick: Tick) -> None:
        linear, angular = tick.truth.robot_velocity
        curves = {
            "curves/visible": marks.visible_fractions(tick, self._names),
            "curves/motion/speed": [linear, tick.command.linear_m_s],
            "curves/motion/turn_rate": [angular, tick.command.angular_rad_s],
        }
        for track in tick.tracks:
            self._name_track(track.id)
            curves[f"curves/confidence/track_{track.id}"] = [track.confidence]
            curves[f"curves/offset/track_{track.id}"] = [marks.track_offset(track, self._thermal.width)]
        for path, values in curves.items():
            self._rows.add(path, rr.Scalars, scalars=np.array(values, np.float64))

    def _name_track(self, number: int) -> None:
        if number in self._tracks_named:
            return
        self._tracks_named.add(number)
        line = rr.SeriesLines(names=[f"track {number}"], colors=[track_colour(number)])
        for kind in ("confidence", "offset"):
            self._log_once(f"curves/{kind}/track_{number}", line)


def open_viewer(recording: Path) -> None:
    """Open a recording in rerun's viewer, and wait until it is closed.

    Raises:
        BadInput: there is no such recording, or the viewer fails, as without a screen.
    """
    if not recording.is_file():
        raise BadInput(f"{recording}: there is no recording; run the scenario without --no-rrd")
    if subprocess.run([sys.executable, "-m", "rerun", str(recording)], check=False).returncode != 0:
        raise BadInput(f"{recording}: rerun's viewer failed; it needs a screen")


def _from_corner(pixels: NDArray[np.float32]) -> NDArray[np.float32]:
    """Count pixels from the corner of the image, as rerun does, not from the middle of the first one."""
    return pixels + np.float32(0.5)


def _planar(pose: Planar) -> dict[str, Any]:
    turn = (0.0, 0.0, np.sin(pose.heading / 2.0), np.cos(pose.heading / 2.0))
    return {"translation": np.array([(pose.x, pose.y, 0.0)]), "quaternion": np.array([turn])}


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


def _blueprint(config: WorldConfig) -> rrb.Blueprint:
    """Lay out: thermal, colour and the world in 3-D above, curves and events below."""
    images = [
        _image_view(_THERMAL, "Thermal: tracks, particles, truth", config.robot.thermal.camera),
        _image_view(_COLOUR, "Colour: tracks, truth", config.robot.colour.camera),
    ]
    plots = [
        _plot("confidence", "Confidence of tracks", (-0.05, 1.05)),
        _plot("visible", "Visible fraction of people", (-0.05, 1.05)),
        _plot("offset", "Offset of tracks [half widths]", (-1.05, 1.05)),
        _plot("motion", "Speed and turn rate"),
    ]
    events = rrb.TextLogView(
        origin="events", name="Events", columns=rrb.TextLogColumns(text_log_columns=["LogLevel", "Body"])
    )
    above = rrb.Horizontal(*images, _world_view(config.place.bounds), column_shares=[1.0, 1.0, 1.4])
    below = rrb.Horizontal(*plots, events, column_shares=[1.0, 1.0, 1.0, 1.0, 1.2])
    return rrb.Blueprint(
        rrb.Vertical(above, below, row_shares=[1.3, 1.0]),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline="time"),
    )


def _image_view(path: str, name: str, camera: Camera) -> rrb.Spatial2DView:
    bounds = rrb.VisualBounds2D(x_range=(0.0, camera.width), y_range=(0.0, camera.height))
    return rrb.Spatial2DView(origin=path, name=name, visual_bounds=bounds)


def _world_view(bounds: tuple[float, float, float, float]) -> rrb.Spatial3DView:
    """Look at the whole place from above and aside; trails are shown from the start up to now."""
    min_x, min_y, max_x, max_y = bounds
    x, y, size = (min_x + max_x) / 2, (min_y + max_y) / 2, max(max_x - min_x, max_y - min_y)
    start, now = rr.TimeRangeBoundary.infinite(), rr.TimeRangeBoundary.cursor_relative()
    so_far = rrb.VisibleTimeRanges(
        [rr.VisibleTimeRange(timeline, start=start, end=now) for timeline in ("frame", "time")]
    )
    # Boxes of people who are near reach far out of the image, and would cross the whole world.
    overlays = [f"- {path}/{layer}" for path in (_THERMAL, _COLOUR) for layer in _LAYERS]
    return rrb.Spatial3DView(
        origin="world",
        contents=["$origin/**", "- $origin/place/ceiling/**", *overlays],
        name="World",
        overrides={"world/trails": so_far},
        eye_controls=rrb.EyeControls3D(
            position=(x - 0.45 * size, y - 0.65 * size, 0.65 * size),
            look_target=(x, y, 0.0),
            eye_up=(0.0, 0.0, 1.0),
        ),
    )


def _plot(kind: str, name: str, span: tuple[float, float] | None = None) -> rrb.TimeSeriesView:
    axis = None if span is None else rrb.ScalarAxis(range=span)
    return rrb.TimeSeriesView(origin=f"curves/{kind}", name=name, axis_y=axis)
