"""The closed loop: the tracker processes images, the behaviour chooses a command, the world advances."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Protocol

from peopleboy.bad_input import BadInput
from peopleboy.behaviours.behaviour import Behaviour, Command
from peopleboy.behaviours.make_behaviour import make_behaviour
from peopleboy.behaviours.percept import Percept, SeenPerson
from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.own_code import OwnCodeFailed, at_frame
from peopleboy.scenarios.loop.camera_health import CameraHealth
from peopleboy.sim.cameras.camera_config import CameraConfig, calibrations_of
from peopleboy.sim.cameras.kinds import flat_geometry, image_names
from peopleboy.sim.observation import Observation, OnDemand, Senses
from peopleboy.sim.robot.robot_body import SONAR_ANGLE_RAD, WHEEL_DISTANCE_M
from peopleboy.sim.truth.scenes import ImageFreeTruth
from peopleboy.sim.truth.truth import Truth
from peopleboy.tracker.boxes import image_shares
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.reproductions.contour.box_interaction import standing_box
from peopleboy.tracker.track import Box, Status, Track
from peopleboy.tracker.trackers import Tracker, explanation_of, make_tracker


def thermal_box(track: Track, calibration: Calibration) -> Box | None:
    """Return a track's box in the thermal image, or the box of a standing person at its floor position.

    Args:
        track: the track.
        calibration: calibration of the thermal camera.

    Returns:
        left, top, width, height [px], possibly outside the image, on the side where the person is; None
        without box and floor position.
    """
    if THERMAL in track.boxes:
        return track.boxes[THERMAL]
    return None if track.place is None else standing_box(track.place, calibration)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Tick:
    """One step of the loop: sensor readings, ground truth, tracks and decisions of one instant.

    Attributes:
        frame: 1, 2, ...
        observation: the robot's sensor readings.
        truths: ground truth by camera that took an image at this instant; for cameras other than `thermal` it
            is computed on first access, which must be before the next tick.
        tracks: output of the tracker.
        explanation: the tracker's explanation, drawn according to its type; None for none.
        mode: mode of the behaviour, such as "search" or "follow".
        command: the robot's next command.
        reason: reason for the mode.
        following: id of the track that the robot follows; None for none.
        failed: error of each failed camera, by name.
    """

    frame: int
    observation: Observation
    truths: Mapping[str, Truth]
    tracks: tuple[Track, ...]
    explanation: object
    mode: str
    command: Command
    reason: str = ""
    following: int | None = None
    failed: Mapping[str, str] = field(default_factory=dict)

    @property
    def truth(self) -> Truth:
        """Ground truth for the thermal camera, with its boxes and masks."""
        return self.truths["thermal"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BlindTick:
    """One step without images, of a robot whose commands do not depend on them.

    Attributes:
        frame: 1, 2, ...
        observation: readings of the other sensors.
        truth: ground truth of the robot; its people are left out.
        mode: mode of the behaviour.
        command: the robot's next command.
    """

    frame: int
    observation: Senses
    truth: ImageFreeTruth
    mode: str
    command: Command


class Stage(Protocol):
    """A world to run the loop in, possibly with sensor faults."""

    def observe(self) -> Observation:
        """Read every sensor once."""
        ...

    @property
    def cameras(self) -> Mapping[str, CameraConfig]:
        """Cameras of the robot, by name."""
        ...

    def truths(self) -> Mapping[str, Truth]:
        """Return the ground truth of this instant, by camera that takes an image."""
        ...

    def step(self, linear_m_s: float, angular_rad_s: float, *, is_emergency: bool = False) -> None:
        """Drive the robot for one control step."""
        ...


class TrackerDown(RuntimeError):  # noqa: N818
    """The tracker fails temporarily; the robot must continue without tracks."""


class Perception:
    """Run the tracker, and detect failed cameras and tracker failures.

    Attributes:
        tracks: tracks of the last image that was processed.
        failed: error of each failed camera, by name.
    """

    def __init__(self, tracker: Tracker, cameras: Mapping[str, CameraConfig]) -> None:
        self._tracker = tracker
        self._cameras = cameras
        self._calibrations = calibrations_of(cameras)
        self._watched = tuple(dict.fromkeys((THERMAL, *tracker.cameras)))
        self._health = CameraHealth(cameras, tuple(name for name in self._watched if name in cameras))
        self._newest: Observation | None = None
        self.tracks: tuple[Track, ...] = ()
        self.failed: Mapping[str, str] = {}

    def perceive(self, observation: Observation) -> Percept:
        """Update the tracker if the images are new, and return the input of the behaviour.

        Images that repeat the last ones are not new, see `CameraHealth`. Images of failed cameras are not
        passed to tracker and behaviour. If possible, the tracker continues with the images of the other
        cameras.
        """
        newest = self._newest
        self.failed = self._health.check(observation)
        sound = self._without_failed(observation)
        percept_of = partial(make_percept, sound, self._cameras, self._calibrations)
        if newest is not None and self._health.only_repeats:
            return percept_of(self.tracks, image_age_s=observation.time_s - newest.time_s)
        before = None if newest is None else newest.odometry
        frame = Frame.from_observation(sound, before, self._calibrations)
        try:
            tracks = self._update(frame)
        except TrackerDown as error:  # the robot must keep driving safely without its tracker
            self._newest, self.tracks = observation, ()
            return percept_of((), fault=f"the tracker failed: {error}")
        if tracks is None:
            self.tracks = ()
            return percept_of((), fault=self._describe_failure())
        self._newest, self.tracks = observation, tracks
        return percept_of(self.tracks)

    def _describe_failure(self) -> str:
        return ", ".join(f"camera {name} failed: {why}" for name, why in self.failed.items())

    def _update(self, frame: Frame) -> tuple[Track, ...] | None:
        """Update the tracker; None if it cannot do without the failed cameras."""
        if not self.failed:
            return self._tracker.update(frame)
        if all(name in self.failed for name in self._tracker.cameras):
            return None
        try:
            return self._tracker.update(frame)
        except (BadInput, OwnCodeFailed):  # such as that the frame has no image of a camera
            return None

    def _without_failed(self, observation: Observation) -> Observation:
        if not self.failed:
            return observation
        lost = {image for name in self.failed for image in image_names(name, self._cameras[name])}
        images = observation.images
        kept = OnDemand([name for name in images if name not in lost], lambda name: images[name])
        return replace(observation, images=kept)


def closed_loop(
    world: Stage, tracker: Tracker | str, behaviour: Behaviour | str, frames: int
) -> Iterator[Tick]:
    """Run the loop for a number of frames, starting at the current instant of the world.

    Args:
        world: the world, such as `World("crossing_2")`.
        tracker: a tracker, or the name of one, made with seed 0.
        behaviour: a behaviour, or the name of one.
        frames: number of frames, at 15 per second.

    Raises:
        BadInput: the tracker or the behaviour returned an invalid value; the message states the frame.
        OwnCodeFailed: a checked tracker or behaviour raised an error.
    """
    tracker = make_tracker(tracker) if isinstance(tracker, str) else tracker
    behaviour = make_behaviour(behaviour) if isinstance(behaviour, str) else behaviour
    perception = Perception(tracker, world.cameras)
    for frame in range(1, frames + 1):
        with at_frame(frame):
            observation = world.observe()
            command = behaviour.command(perception.perceive(observation))
            tick = Tick(
                frame=frame,
                observation=observation,
                truths=world.truths(),
                tracks=perception.tracks,
                explanation=explanation_of(tracker),
                mode=behaviour.mode,
                command=command,
                reason=behaviour.reason,
                following=behaviour.following,
                failed=perception.failed,
            )
        yield tick
        if frame < frames:
            world.step(command.linear_m_s, command.angular_rad_s, is_emergency=command.is_emergency)


def make_percept(
    observation: Observation,
    cameras: Mapping[str, CameraConfig],
    calibrations: Mapping[str, Calibration],
    tracks: tuple[Track, ...],
    *,
    image_age_s: float = 0.0,
    fault: str = "",
) -> Percept:
    """Return the input of the behaviour: confirmed tracks, sonar ranges, speeds and pose from the wheels."""
    camera = flat_geometry(cameras, THERMAL)
    thermal, height, width = calibrations[THERMAL], camera.height, camera.width
    people = tuple(
        see_person(track, box, width, height)
        for track in tracks
        if track.status is not Status.TENTATIVE and (box := thermal_box(track, thermal)) is not None
    )
    left, right = observation.wheel_speeds_m_s
    return Percept(
        time_s=observation.time_s,
        people=people,
        sonar_m=observation.sonar_m,
        sonar_angle_rad=SONAR_ANGLE_RAD,
        linear_m_s=(left + right) / 2.0,
        angular_rad_s=(right - left) / WHEEL_DISTANCE_M,
        odometry=observation.odometry,
        images=observation.images,
        image_age_s=image_age_s,
        fault=fault,
    )


def see_person(track: Track, box: Box, width: int, height: int) -> SeenPerson:
    """Convert a track's box [px] to shares of the image size."""
    shares = image_shares(box, width, height)
    return SeenPerson(
        id=track.id,
        x=shares.x,
        height=shares.height,
        top=shares.top,
        bottom=shares.bottom,
        confidence=track.confidence,
        is_visible=track.status is not Status.TOTALLY_OCCLUDED,
        position_m=None if track.place is None else track.place.position_m,
        velocity_m_s=None if track.place is None else track.place.velocity_m_s,
    )
