"""Write a run as a rerun recording, tick by tick; `layout` lists its entities."""

import math
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.drawing.overlay import encode_jpeg, encode_png, people_parts, track_parts
from peopleboy.scenarios.drawing.palette import person_colour
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.loop.run_events import LogLine, describe_fully
from peopleboy.scenarios.recording import marks
from peopleboy.scenarios.recording.explanations import (
    draw_explained_lines,
    draw_explained_points,
    draw_explained_sketches,
    likeness_by_track,
)
from peopleboy.scenarios.recording.layout import (
    BACKGROUND,
    EVENTS,
    JPEG,
    OCCLUSIONS,
    PLACES,
    THERMAL,
    TRAILS,
    Still,
    camera_path,
    lay_out,
    person_path,
    points_path,
    thing_path,
)
from peopleboy.scenarios.recording.marks import Arrows, believed_arrows, true_arrows, world_arrows
from peopleboy.scenarios.recording.rows import METRE_STEP, PIXEL_STEP, TURN_STEP, RecordingWriter, rounded
from peopleboy.scenarios.recording.solids import NO_CAPSULES, body_capsules
from peopleboy.sim.cameras.camera_config import DepthConfig, LaserConfig
from peopleboy.sim.cameras.depth import points_of
from peopleboy.sim.cameras.kinds import colour_from_thermal, shown_to_people, with_boxes
from peopleboy.sim.geometry.pinhole import Matrix, invert_pose, transform
from peopleboy.sim.shapes.shapes import Vector
from peopleboy.sim.truth.truth import ThingTruth
from peopleboy.sim.world_config import WorldConfig

_FRAMES_SENT_TOGETHER = 15
_JPEG_QUALITY = 45
_POINTS = 10_000  # approximate number of points in the cloud of a depth image
_NAME_HEIGHT = 1.0 / 15.0  # [image heights] of names above boxes
_SCAN_COLOUR = (240, 228, 66)  # of the points of a scan that are not on people
_GONE = 1e-4  # scale at which an absent object is drawn
_GRAVE = ("contact", "lost", "fault starts")


class Recorder(RecordingWriter):
    """Writes the recording of a run while it is running; use it as a context manager.

    The file is written every 15 frames, so that a killed run leaves a file that opens, and lacks at most
    these frames.

    Args:
        path: the file to write.
        config: configuration of the world.
        title: name of the recording; the same title gives the same recording id.
        viewer: address of a viewer that shows it live; None for none.
        watched: cameras that the tracker uses.
        attends: whether the tracker explains its search for a person in colour images.
        is_lossless: whether images are kept lossless, not as JPEG.
    """

    def __init__(
        self,
        path: Path,
        config: WorldConfig,
        *,
        title: str,
        viewer: str | None = None,
        watched: Collection[str] = (),
        attends: bool = False,
        is_lossless: bool = False,
    ) -> None:
        blueprint = lay_out(config, watched, attends=attends, follows=viewer is not None)
        super().__init__(path, title, viewer, blueprint)
        self._is_lossless = is_lossless
        self._cameras = config.robot.cameras
        self._boxed = with_boxes(self._cameras)
        self._reports_cameras = bool({*self._boxed} - {"thermal", "colour"})
        self._width = self._cameras["thermal"].camera.width
        self._colour_from_thermal = colour_from_thermal(self._cameras)
        self._backgrounds: dict[str, NDArray[np.uint8]] = {}
        self._names = [person.name for person in config.people]
        self._trails = marks.Trails()
        self._things: dict[str, tuple[Vector, float, bool]] = {}
        self._sightings = marks.Sightings(self._boxed)
        self._tracks_named: set[int] = set()
        self._compared: set[int] = set()
        self._tracked = {"thermal"}
        self._has_places = False
        self.stream.send_recording_name(title)
        self._still = Still(self.stream, "image/png" if is_lossless else JPEG)
        self._still.log_world(config)

    def log(self, tick: Tick, events: Sequence[LogLine]) -> None:
        """Add one tick and its events."""
        self.begin(tick.frame, tick.observation.time_s)
        self._log_images(tick)
        self._log_tracks(tick)
        self._log_points(tick)
        self._log_sketches(tick)
        self._log_truth(tick)
        self._log_world(tick)
        self._log_curves(tick)
        for line in events:
            level = "WARN" if line.kind.startswith(_GRAVE) else "INFO"
            self.add(EVENTS, rr.TextLog, text=[describe_fully(line)], level=[level])
        self.send_if_due(_FRAMES_SENT_TOGETHER)

    def _log_images(self, tick: Tick) -> None:
        images = tick.observation.images
        for name in (name for name in self._cameras if name in images):
            config = self._cameras[name]
            if isinstance(config, DepthConfig):
                self._log_depth(name, config, tick)
                continue
            if isinstance(config, LaserConfig):
                self._log_scan(name, config, tick)
                continue
            blob = self._encoded(shown_to_people(images, name, config))
            self.add(f"{camera_path(name)}/image", rr.EncodedImage, blob=[blob])

    def _encoded(self, image: NDArray[np.uint8]) -> bytes:
        if self._is_lossless:
            return encode_png(image)
        return encode_jpeg(image, _JPEG_QUALITY, has_own_codes=False)

    def _log_depth(self, name: str, config: DepthConfig, tick: Tick) -> None:
        """Log a depth image without loss, and its point cloud in the world."""
        images = tick.observation.images
        self.add(f"{camera_path(name)}/image", rr.EncodedDepthImage, blob=[encode_png(images[name])])
        colour = images[f"{name}_colour"] if config.colour else shown_to_people(images, name, config)
        every = max(round(math.sqrt(images[name].size / _POINTS)), 1)
        places, pixels = points_of(images[name], config.camera, every)
        world = transform(tick.truths[name].world_from_camera, places.astype(np.float64))
        colours = colour[pixels[:, 0], pixels[:, 1]]
        self.add(points_path(name), rr.Points3D, positions=rounded(world, METRE_STEP), colors=colours)

    def _log_scan(self, name: str, config: LaserConfig, tick: Tick) -> None:
        """Log the points of a scan in the world; those on a person have the person's colour."""
        truth, ranges, plane = tick.truths[name], tick.observation.images[name][0], config.camera
        is_read = ranges > 0
        flat = plane.calibration.points(ranges / 1000.0)[is_read]
        points = np.column_stack([flat, np.full(len(flat), plane.position_m[2])])
        world = transform(truth.world_from_camera @ invert_pose(plane.robot_from_camera), points)
        people = truth.instance[0][is_read].tolist()
        colours = [person_colour(one) if one else _SCAN_COLOUR for one in people]
        self.add(points_path(name), rr.Points3D, positions=rounded(world, METRE_STEP), colors=colours)

    def _log_tracks(self, tick: Tick) -> None:
        contours = draw_explained_lines(tick.explanation, tick)
        strips, colours = _from_corner(contours.line), contours.colour
        self.add(f"{THERMAL}/tracks/contours", rr.LineStrips2D, strips=strips, colors=colours)
        self._tracked |= {camera for track in tick.tracks for camera in track.boxes}
        for name in self._boxed:
            if name in self._tracked:
                boxes = marks.track_boxes(track_parts(tick.tracks, name, self._cameras[name].camera), name)
            elif name == "colour":
                boxes = marks.track_boxes(tick.tracks, affine=self._colour_from_thermal)
            else:
                continue
            self._log_boxes(f"{camera_path(name)}/tracks/boxes", boxes, labels=boxes.label)
        self._log_arrows("tracks/occlusions", believed_arrows(tick.tracks))
        self._log_places(tick)

    def _log_places(self, tick: Tick) -> None:
        self._has_places |= any(track.place is not None for track in tick.tracks)
        if self._has_places:
            seen = self._sightings.update(tick) if self._reports_cameras else {}
            places = marks.places(tick.tracks, seen)
            self.add(
                PLACES, rr.Ellipsoids3D, centers=rounded(places.centre, METRE_STEP),
                half_sizes=rounded(places.half_size, METRE_STEP), quaternions=places.quaternion,
                colors=places.colour, labels=places.label,
            )  # fmt: skip

    def _log_arrows(self, layer: str, arrows: Arrows) -> None:
        self.add(
            f"{THERMAL}/{layer}", rr.Arrows2D, origins=_from_corner(arrows.start),
            vectors=rounded(arrows.vector, PIXEL_STEP), colors=arrows.colour, labels=arrows.label,
        )  # fmt: skip

    def _log_points(self, tick: Tick) -> None:
        for layer, points in draw_explained_points(tick.explanation).items():
            place, colour = _from_corner(points.place), points.colour
            self.add(f"{THERMAL}/{layer}", rr.Points2D, positions=place, colors=colour)

    def _log_sketches(self, tick: Tick) -> None:
        """Log the tracker's explanation of further cameras' new images, and backgrounds that have changed."""
        sketches = draw_explained_sketches(tick.explanation, tick.tracks, self._cameras)
        for camera, sketch in ((c, s) for c, s in sketches.items() if c in tick.observation.images):
            path = camera_path(camera)
            empty = sketch.background
            if empty is not None and not np.array_equal(self._backgrounds.get(camera, ()), empty):
                self._backgrounds[camera] = empty
                blob = encode_jpeg(empty, _JPEG_QUALITY, has_own_codes=False)
                self.add(f"{path}/{BACKGROUND}", rr.EncodedImage, blob=[blob], media_type=[JPEG])
            strips = [_from_corner(line) for line in sketch.lines]
            self.add(f"{path}/explained/lines", rr.LineStrips2D, strips=strips, colors=sketch.colour)

    def _log_truth(self, tick: Tick) -> None:
        for name in (name for name in self._boxed if name in tick.truths):
            self._log_named_boxes(
                name, marks.truth_boxes(people_parts(tick.truths[name].people, self._cameras[name].camera))
            )
        self._log_arrows("truth/occlusions", true_arrows(tick.truth.people))

    def _log_named_boxes(self, camera: str, boxes: marks.Boxes) -> None:
        path, lift_px = camera_path(camera), _NAME_HEIGHT * self._cameras[camera].camera.height
        self._log_boxes(f"{path}/truth/boxes", boxes)
        above = _from_corner(boxes.box[:, :2]) + boxes.box[:, 2:] * (0.5, 0.0) - (0.0, lift_px)
        # Panoramas often cut off heads: their names move down to the top border.
        above[:, 1] = np.maximum(above[:, 1], 0.0)
        self.add(f"{path}/truth/names", rr.Points2D, positions=above, colors=boxes.colour, labels=boxes.label)

    def _log_boxes(self, path: str, boxes: marks.Boxes, **labels: list[str]) -> None:
        half = rounded(boxes.box[:, 2:] / 2.0, PIXEL_STEP)
        centre = _from_corner(boxes.box[:, :2]) + half
        self.add(path, rr.Boxes2D, centers=centre, half_sizes=half, colors=boxes.colour, **labels)

    def _log_world(self, tick: Tick) -> None:
        self.add("world/robot", rr.Transform3D, **_planar(tick.truth.robot))
        trails, arrows = self._trails.update(tick), world_arrows(tick.truth.people)
        self.add(TRAILS, rr.LineStrips3D, strips=trails.line, colors=trails.colour)
        self.add(
            OCCLUSIONS, rr.Arrows3D, origins=arrows.start, vectors=arrows.vector, colors=arrows.colour,
            labels=arrows.label,
        )  # fmt: skip
        for thing in tick.truth.things:
            self._log_thing(thing)
        joints = {person.name: person.joints_m for person in tick.truth.people}
        for name in self._names:
            self._log_person(person_path(name), joints.get(name))

    def _log_thing(self, thing: ThingTruth) -> None:
        """Log the pose of an object if it has changed; an absent object is scaled to an invisible size."""
        place = (thing.position_m, thing.heading_rad, thing.is_there)
        if self._things.get(thing.name) == place:
            return
        self._things[thing.name] = place
        x, y, z = thing.position_m
        half = thing.heading_rad / 2.0
        self.add(
            thing_path(thing.name), rr.Transform3D, translation=np.array([(x, y, z)]),
            quaternion=np.array([(0.0, 0.0, np.sin(half), np.cos(half))]),
            scale=np.full((1, 3), 1.0 if thing.is_there else _GONE),
        )  # fmt: skip

    def _log_person(self, path: str, joints: Matrix | None) -> None:
        body = NO_CAPSULES if joints is None else body_capsules(joints)
        self.add(
            f"{path}/body", rr.Capsules3D, translations=rounded(body.start, METRE_STEP),
            quaternions=rounded(body.quaternion, TURN_STEP), lengths=rounded(body.length, METRE_STEP),
            radii=rounded(body.radius, METRE_STEP / 2),
        )  # fmt: skip

    def _log_curves(self, tick: Tick) -> None:
        linear, angular = tick.truth.robot_velocity
        curves = {
            "curves/visible": marks.visible_fractions(tick, self._names),
            "curves/motion/speed": [linear, tick.command.linear_m_s],
            "curves/motion/turn_rate": [angular, tick.command.angular_rad_s],
        }
        for track in tick.tracks:
            if track.id not in self._tracks_named:
                self._tracks_named.add(track.id)
                self._still.log_track(track.id)
            curves[f"curves/confidence/track_{track.id}"] = [track.confidence]
            box = track.boxes.get("thermal")  # NaN interrupts the line
            offset = math.nan if box is None else marks.box_offset(box, self._width)
            curves[f"curves/offset/track_{track.id}"] = [offset]
        for number, likeness in likeness_by_track(tick.explanation).items():
            if number not in self._compared:
                self._compared.add(number)
                self._still.log_track(number, ("likeness",))
            curves[f"curves/likeness/track_{number}"] = [likeness]
        for path, values in curves.items():
            self.add(path, rr.Scalars, scalars=np.array(values, np.float64))


def _from_corner(pixels: NDArray[np.floating]) -> NDArray[np.float32]:
    """Convert pixels to rerun's convention: counted from the image's corner, not the first pixel's centre."""
    return rounded(pixels, PIXEL_STEP) + np.float32(0.5)


def _planar(pose: Pose2) -> dict[str, Any]:
    turn = (0.0, 0.0, np.sin(pose.heading / 2.0), np.cos(pose.heading / 2.0))
    return {"translation": np.array([(pose.x, pose.y, 0.0)]), "quaternion": np.array([turn])}
