"""Write a scene model's estimate as a recording that overlays that of the run."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import rerun as rr

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.drawing.palette import person_colour, track_colour
from peopleboy.scenarios.recording.marks import Colours
from peopleboy.scenarios.recording.rows import RecordingWriter
from peopleboy.tracker.frame import Floats
from peopleboy.tracker.scene_model.geometry import Geometry
from peopleboy.tracker.scene_model.scene import Metres, VistaScene
from peopleboy.tracker.scene_model.vista_spaces import Surface

_SCENE = "world/scene"
_GREY = (170, 170, 170)
_POINT_M = 0.015
_MOST = 4000  # most points of objects in a frame


class SceneRecording(RecordingWriter):
    """Writes static map, objects and people in world coordinates; use it as a context manager.

    Args:
        path: the file to write.
        title: title of the run's recording, with which viewers merge this one.
        first: initial pose of the robot in the world.
    """

    def __init__(self, path: Path, title: str, first: Pose2) -> None:
        super().__init__(path, title)
        self._pose = first

    def log(self, frame: int, scene: VistaScene, depth_m: Metres, geometry: Geometry, pose: Pose2) -> None:
        """Add a frame: objects as coloured points, people as ellipsoids."""
        self.begin(frame, scene.time_s)
        points, colours = _coloured(scene, depth_m, geometry)
        world = self._pose.compose(pose).transform_points(points).astype(np.float32)
        self.add(f"{_SCENE}/things", rr.Points3D, positions=world, colors=colours)
        places = [(*self._pose.transform_point(one.place_m), 0.9) for one in scene.persons]
        shades = [person_colour(one.id) for one in scene.persons]
        labels = [f"person {one.id}" for one in scene.persons]
        self.add(
            f"{_SCENE}/people",
            rr.Ellipsoids3D,
            centers=np.array(places, np.float32).reshape(-1, 3),
            half_sizes=np.tile(np.array([0.25, 0.25, 0.9], np.float32), (len(places), 1)),
            colors=np.array(shades, np.uint8).reshape(-1, 3),
            labels=labels,
        )

    def log_events(self, lines: Sequence[tuple[float, str]]) -> None:
        """Add events at the times [s] when they were reported."""
        for time_s, line in lines:
            self.stream.set_time("time", duration=time_s)
            self.stream.log("events", rr.TextLog(line, level="INFO"), strict=True)
        self.stream.reset_time()

    def log_map(self, surface: Surface) -> None:
        """Add the static map."""
        world = self._pose.transform_points(surface.points_m)
        points = rr.Points3D(world, colors=_GREY, radii=_POINT_M)
        self.stream.log(f"{_SCENE}/static", points, static=True, strict=True)


def _coloured(scene: VistaScene, depth_m: Metres, geometry: Geometry) -> tuple[Floats, Colours]:
    """Return the points (N, 3) of all objects in the robot's frame, and their colours (N, 3)."""
    pixels = np.flatnonzero((scene.things > 0) & (depth_m > 0.0))
    pixels = pixels[:: max(math.ceil(len(pixels) / _MOST), 1)]
    numbers = scene.things.ravel()[pixels].tolist()
    colours = np.array([track_colour(number) for number in numbers], np.uint8).reshape(-1, 3)
    return geometry.points(pixels, depth_m), colours
