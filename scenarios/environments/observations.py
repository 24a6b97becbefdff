"""Build the observations of an environment: images, tracks, or ground truth in the form of tracks.

Numbers can be scaled to -1..1, as most learners need; images stay unscaled.
"""

import math
from collections.abc import Iterable, Sequence
from typing import Any, Final

import numpy as np
from gymnasium import spaces
from numba import njit
from numpy.typing import NDArray

from peopleboy.scenarios.loop.loop import thermal_box
from peopleboy.sim.batch.sensing import Snapshot
from peopleboy.sim.cameras.camera_config import CameraConfig, calibrations_of
from peopleboy.sim.cameras.kinds import kind_of
from peopleboy.sim.physics.solid_shapes import Array
from peopleboy.sim.robot.robot_body import WHEEL_DISTANCE_M
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.shapes.shape_table import Numbers
from peopleboy.sim.truth.scenes import SEEN, Records, Scenes
from peopleboy.tracker.boxes import image_shares
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import Status, Track

_image_shares = njit(cache=True)(image_shares)


@njit(cache=True, nogil=True)
def fill_odometry(starts: Array, now: Array, wheels: Array, found: NDArray[np.float32]) -> None:
    """Fill `odometry`.

    Args:
        starts: (G, 3) x, y [m], heading [rad] from odometry at the start of the episodes.
        now: (G, 3) the same at the current instant.
        wheels: (G, 2) [m/s] rim speeds, left and right.
        found: (G, 6) output: x, y [m] in the frame of the start pose, cosine and sine of the heading since
            the start, forward speed [m/s], turn rate [rad/s].
    """
    for row in range(len(starts)):
        cos, sin = math.cos(starts[row, 2]), math.sin(starts[row, 2])
        dx, dy = now[row, 0] - starts[row, 0], now[row, 1] - starts[row, 1]
        turned = now[row, 2] - starts[row, 2]
        left, right = wheels[row, 0], wheels[row, 1]
        found[row, 0], found[row, 1] = cos * dx + sin * dy, cos * dy - sin * dx
        found[row, 2], found[row, 3] = math.cos(turned), math.sin(turned)
        found[row, 4], found[row, 5] = (left + right) / 2.0, (right - left) / WHEEL_DISTANCE_M


@njit(cache=True, nogil=True)
def fill_tracks(
    people: Array,
    borders: Numbers,
    width: int,
    height: int,
    farthest: float,
    lowest: tuple[float, ...],
    highest: tuple[float, ...],
    found: NDArray[np.float32],
) -> None:
    """Fill `tracks`, the tallest person first, and the remaining rows with zeros.

    Args:
        people: (Q, 7) id, box [px], confidence and is_visible, of all worlds; rows with a box of NaN are
            empty.
        borders: (G, 2) first and end row of each world.
        width: [px] image width.
        height: [px] image height.
        farthest: [half image widths] distance from the image centre beyond which people are left out.
        lowest: minimum of each column.
        highest: maximum of each column.
        found: (G, 5 * 7) output.
    """
    columns = people.shape[1]
    rows = np.empty(people.shape)
    found[:] = 0.0
    for row in range(len(borders)):
        first, end = borders[row, 0], borders[row, 1]
        for q in range(first, end):
            left, top, across, up = people[q, 1], people[q, 2], people[q, 3], people[q, 4]
            shares = _image_shares((left, top, across, up), width, height)
            rows[q, 0], rows[q, 5], rows[q, 6] = people[q, 0], people[q, 5], people[q, 6]
            rows[q, 1], rows[q, 2], rows[q, 3], rows[q, 4] = shares
            if not abs(rows[q, 1]) <= farthest:
                rows[q, 2] = -np.inf
        for place in range(min(found.shape[1] // columns, end - first)):
            tallest = first + np.argmax(rows[first:end, 2])
            if rows[tallest, 2] == -np.inf:
                break
            for k in range(columns):
                number = min(max(rows[tallest, k], lowest[k]), highest[k])
                found[row, place * columns + k] = number
            rows[tallest, 2] = -np.inf


@njit(cache=True, nogil=True)
def fill_goal(goals: Array, now: Array, found: NDArray[np.float32]) -> None:
    """Fill `goal`.

    Args:
        goals: (G, 2) [m] x, y of the goals, world frame.
        now: (G, 3) x, y [m], heading [rad] from odometry, which starts in the world frame.
        found: (G, 3) output: distance [m], cosine and sine of the bearing from the heading.
    """
    for row in range(len(goals)):
        dx, dy = goals[row, 0] - now[row, 0], goals[row, 1] - now[row, 1]
        bearing = math.atan2(dy, dx) - now[row, 2]
        found[row, 0], found[row, 1], found[row, 2] = math.hypot(dx, dy), math.cos(bearing), math.sin(bearing)


Arrays = dict[str, NDArray[Any]]

KINDS: Final = ("pixels", "tracks", "truth")
MOST_TRACKS: Final = 5
COLUMNS: Final = ("id", "x", "height", "top", "bottom", "confidence", "is_visible")
"""The seven columns of each of the five people in `tracks`, ordered from the tallest, which is the nearest.

id is 1 or more and constant for a person; a row of zeros is empty. x is in half image widths, -1 at the left
border, +1 at the right border; height, top and bottom are in image heights from the top; confidence is 0..1;
is_visible is 0 while a person is totally occluded.
"""

_LOWEST: Final = (0.0, -10.0, 0.0, -10.0, -10.0, 0.0, 0.0)
_HIGHEST: Final = (1e6, 10.0, 10.0, 10.0, 10.0, 1.0, 1.0)
_SONARS: Final = 16
_FARTHEST_M: Final = 1e4
_FASTEST: Final = 10.0


def observation_space(
    kind: str, robot: RobotConfig, shown: Sequence[str], *, has_goal: bool = False
) -> spaces.Space[Arrays]:
    """Return the space of one of `KINDS`.

    `sonar` is (16,) [m], counted from the left through the front; `odometry` is (6,): x, y [m] in the frame
    of the start pose, cosine and sine of the heading since the start, forward speed [m/s], turn rate [rad/s].
    With a goal, `goal` is (3,): its distance [m], cosine and sine of its bearing, by odometry.
    `pixels` adds the newest image of each camera in `shown` under its name, (H, W, 1) or (H, W, 3) uint8,
    such as `thermal` and `colour`, or for a depth camera (H, W, 1), for a laser range finder (1, N, 1) uint16
    [mm]; `tracks` and `truth` add
    `tracks` (35,), five rows of `COLUMNS`.
    """
    sonar = robot.sonar
    odometry = np.array([_FARTHEST_M, _FARTHEST_M, 1.0, 1.0, _FASTEST, _FASTEST], np.float32)
    found: dict[str, spaces.Space[Any]] = {
        "sonar": spaces.Box(sonar.nearest_m, sonar.farthest_m, (_SONARS,), np.float32),
        "odometry": spaces.Box(-odometry, odometry, dtype=np.float32),
    }
    if has_goal:
        goal = np.array([_FARTHEST_M, 1.0, 1.0], np.float32)
        lowest = np.array([0.0, -1.0, -1.0], np.float32)
        found["goal"] = spaces.Box(lowest, goal, dtype=np.float32)
    if kind == "pixels":
        for name in shown:
            camera = robot.cameras[name]
            dtype = kind_of(camera).dtype
            found[name] = spaces.Box(0, int(np.iinfo(dtype).max), image_shape(camera), dtype)
    else:
        lowest, highest = (np.tile(np.array(row, np.float32), MOST_TRACKS) for row in (_LOWEST, _HIGHEST))
        found["tracks"] = spaces.Box(lowest, highest, dtype=np.float32)
    return spaces.Dict(found)  # type: ignore[return-value]  # typed there as if samples were spaces


def read_sensors(snapshot: Snapshot, starts: Array) -> Arrays:
    """Return the entries that every observation of G worlds has: sonar (G, 16) and odometry (G, 6).

    Args:
        snapshot: snapshot of the worlds.
        starts: (G, 3) x, y [m], heading [rad] from odometry at the start of each episode.
    """
    odometry = np.empty((len(starts), 6), np.float32)
    fill_odometry(starts, snapshot.odometry, snapshot.wheel_speeds_m_s, odometry)
    return {"sonar": snapshot.sonar_m.astype(np.float32), "odometry": odometry}


def observe_tracks(tracks: Iterable[Track], robot: RobotConfig) -> NDArray[np.float32]:
    """Return the confirmed tracks of one world: (35,)."""
    thermal = calibrations_of(robot.cameras)[THERMAL]
    rows = [
        (track.id, *box, track.confidence, track.status is not Status.TOTALLY_OCCLUDED)
        for track in tracks
        if track.status is not Status.TENTATIVE and (box := thermal_box(track, thermal)) is not None
    ]
    found = _fill(np.array(rows, np.float64).reshape(-1, 7), np.array([[0, len(rows)]]), robot)
    return found.reshape(-1)


def observe_truth(scenes: Scenes, robot: RobotConfig) -> NDArray[np.float32]:
    """Return the output of a perfect tracker in G worlds, with all people in the image: (G, 35)."""
    people = scenes.people
    seen, sure = people["free_ray_share"] > SEEN, np.ones(len(people))
    rows = np.column_stack([people["id"], people["box"], sure, seen])
    borders = np.column_stack([scenes.worlds["first"], scenes.worlds["end"]])
    return _fill(rows, borders, robot, farthest=1.0)  # people whose centre is between the image borders


def image_shape(camera: CameraConfig) -> tuple[int, int, int]:
    """Return the shape (H, W, C) of a camera's images in an observation."""
    return camera.camera.height, camera.camera.width, kind_of(camera).channels


def _fill(
    people: Array, borders: Numbers, robot: RobotConfig, farthest: float = np.inf
) -> NDArray[np.float32]:
    """Fill `tracks` (G, 35): the tallest person first, and the remaining rows with zeros.

    Args:
        people: (Q, 7) id, box [px], confidence and is_visible, one world after the other.
        borders: (G, 2) first and end row of each world.
        robot: robot with the thermal camera whose image contains the boxes.
        farthest: [half image widths] distance from the image centre beyond which people are left out.
    """
    camera = robot.cameras["thermal"].camera
    found = np.empty((len(borders), MOST_TRACKS * len(COLUMNS)), np.float32)
    fill_tracks(people, borders, camera.width, camera.height, farthest, _LOWEST, _HIGHEST, found)
    return found


AWAY_M: Final = 20.0
"""[m] x and y of `odometry`, and distance of `goal`, that are scaled to 1."""

IMAGES: Final = 2.0
"""[image heights] height, top and bottom of `tracks` that are scaled to 1."""

_SCALES: Final = (1.0, 1.0, IMAGES, IMAGES, IMAGES, 1.0, 1.0)
_LOWEST_SHARES: Final = (0.0, -1.0, 0.0, -1.0, -1.0, 0.0, 0.0)


class Normaliser:
    """Scale the numbers of an observation to -1..1; larger values are clipped.

    | entry | scaled to |
    |---|---|
    | `sonar` | 0..1, shares of the sonars' range |
    | `odometry` x, y | -1..1 for -20..20 m |
    | `odometry` cosine, sine | unchanged |
    | `odometry` speed, turn rate | -1..1, shares of the drive's limits |
    | `goal` distance | 0..1 for 0..20 m |
    | `goal` cosine, sine | unchanged |
    | `tracks` id | 1 for a person, 0 for none; people keep their rows, new people take the first free row |
    | `tracks` x | -1..1, half image widths |
    | `tracks` height, top, bottom | 0..1, -1..1, -1..1 for two image heights |
    | `tracks` confidence, is_visible | unchanged |
    | images | unchanged |
    """

    def __init__(self, robot: RobotConfig) -> None:
        drive = robot.drive
        self._reach_m = robot.sonar.farthest_m
        self._odometry = np.array(
            [AWAY_M, AWAY_M, 1.0, 1.0, drive.max_linear_m_s, drive.max_angular_rad_s], np.float32
        )

    def space(self, raw: spaces.Space[Arrays]) -> spaces.Space[Arrays]:
        """Return the space of scaled observations for the space of raw ones."""
        lowest = {
            "sonar": np.zeros(raw["sonar"].shape, np.float32),  # type: ignore[index]  # it is a Dict
            "odometry": -np.ones(len(self._odometry), np.float32),
            "goal": np.array([0.0, -1.0, -1.0], np.float32),
            "tracks": np.tile(np.array(_LOWEST_SHARES, np.float32), MOST_TRACKS),
        }
        return spaces.Dict(  # type: ignore[return-value]  # typed there as if samples were spaces
            {
                name: spaces.Box(lowest[name], 1.0, dtype=np.float32) if name in lowest else space
                for name, space in raw.spaces.items()  # type: ignore[attr-defined]
            }
        )

    def __call__(self, observation: Arrays, holders: NDArray[np.float64]) -> Arrays:
        """Scale the next observations of G worlds.

        Args:
            observation: as in `observation_space`, with worlds as the first axis.
            holders: (G, 5) ids of the people in the rows of `tracks`, updated in place; 0 for none, as at
                the start of an episode.
        """
        found = observation | {
            "sonar": np.clip(observation["sonar"] / self._reach_m, 0.0, 1.0),
            "odometry": np.clip(observation["odometry"] / self._odometry, -1.0, 1.0),
        }
        if "goal" in observation:
            found["goal"] = np.minimum(observation["goal"] / np.array([AWAY_M, 1.0, 1.0], np.float32), 1.0)
        if "tracks" in observation:
            given = observation["tracks"].reshape(-1, MOST_TRACKS, len(COLUMNS))
            shares = np.clip(given / _SCALES, _LOWEST_SHARES, 1.0)
            found["tracks"] = np.empty_like(observation["tracks"])
            _keep_rows(given, shares, holders, found["tracks"].reshape(given.shape))
        return found


@njit(cache=True, nogil=True)
def _keep_rows(given: NDArray[np.float32], shares: Array, holders: Array, found: NDArray[np.float32]) -> None:
    """Keep each person in the same row as before, and put new people into the first free row.

    Args:
        given: (G, 5, 7) raw tracks.
        shares: (G, 5, 7) the same tracks, scaled.
        holders: (G, 5) see `Normaliser`.
        found: (G, 5, 7) output.
    """
    found[:] = 0.0
    for world in range(len(given)):
        numbers, places = given[world, :, 0], holders[world]
        for place in range(len(places)):
            if not (numbers == places[place]).any():
                places[place] = 0.0
        for row in range(len(numbers)):
            if numbers[row] > 0.0 and not (places == numbers[row]).any():
                places[np.argmax(places == 0.0)] = numbers[row]
        for place in range(len(places)):
            if places[place] > 0.0:
                found[world, place] = shares[world, np.argmax(numbers == places[place])]


class ObservationBuilder:
    """Build the observations of one kind, for one world or many.

    Args:
        kind: one of `KINDS`.
        robot: robot with the cameras, the same in all worlds.
        shown: names of the cameras whose images `pixels` contains.
        normaliser: scales numbers to -1..1; None leaves them unscaled.
        has_goal: whether the observations contain the direction of the robot's goal.

    Attributes:
        tracks: whether the observations need a tracker.
        slow: names of the cameras that do not take an image at every step.
    """

    def __init__(
        self,
        kind: str,
        robot: RobotConfig,
        shown: Sequence[str],
        normaliser: Normaliser | None,
        *,
        has_goal: bool,
    ) -> None:
        self._has_goal = has_goal
        self._kind, self._robot, self._normaliser = kind, robot, normaliser
        self._shapes = {name: image_shape(robot.cameras[name]) for name in shown} if kind == "pixels" else {}
        self.tracks = kind == "tracks"
        self.slow = [name for name in self._shapes if robot.cameras[name].rate_hz]

    def build(self, snapshot: Snapshot, episodes: Records, tracks: NDArray[np.float32] | None) -> Arrays:
        """Return all entries except images, with worlds as the first axis.

        Args:
            snapshot: snapshot of G worlds.
            episodes: (B,) records EPISODE.
            tracks: (G, 35) output of the trackers; None without trackers.
        """
        numbers = snapshot.numbers
        found = read_sensors(snapshot, episodes["start"][numbers])
        if self._has_goal:
            found["goal"] = np.empty((len(numbers), 3), np.float32)
            fill_goal(episodes["goal"][numbers], snapshot.odometry, found["goal"])
        if self._kind == "truth":
            found["tracks"] = observe_truth(snapshot.scenes, self._robot)
        elif tracks is not None:
            found["tracks"] = tracks
        if self._normaliser is not None:
            holders = episodes["holders"][numbers]
            found = self._normaliser(found, holders)
            episodes["holders"][numbers] = holders
        return found

    def images(self, snapshot: Snapshot) -> dict[str, tuple[Sequence[int], NDArray[Any]]]:
        """Return the images of `pixels`: by camera, the worlds with a new image, and these images."""
        found = {}
        for name, shape in self._shapes.items():
            assert snapshot.images is not None
            rows, images = snapshot.images.of_camera(name)
            if rows:
                found[name] = rows, np.asarray(images).reshape(-1, *shape)
        return found
