"""The closed loop: senses become tracks, tracks become a command, and the command moves the world."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from peopleboy.behaviours.behaviour import Behaviour, Command
from peopleboy.behaviours.make_behaviour import make_behaviour
from peopleboy.behaviours.percept import Percept, SeenPerson
from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.own_code import at_frame
from peopleboy.sim.cameras.camera_config import CameraConfig, calibrations_of
from peopleboy.sim.observation import Observation
from peopleboy.sim.robot.robot_body import SONAR_ANGLE_RAD, WHEEL_DISTANCE_M
from peopleboy.sim.truth.truth import Truth
from peopleboy.tracker.boxes import image_shares
from peopleboy.tracker.contour.box_interaction import standing_box
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.track import Box, Status, Track
from peopleboy.tracker.trackers import Tracker, explanation_of, knows_again, make_tracker


def thermal_box(track: Track, calibration: Calibration) -> Box | None:
    """Return a track's own box, or that of a person who stands at its place; None for one without a place.

    Args:
        track: whose.
        calibration: of the thermal camera.

    Returns:
        left, top, width, height [px], which may lie outside the image: to that side the person is then.
    """
    if THERMAL in track.boxes:
        return track.boxes[THERMAL]
    return None if track.place is None else standing_box(track.place, calibration)


Images = Mapping[str, NDArray[Any]]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Tick:
    """One turn of the loop: everything that was sensed, true, tracked and decided at one instant.

    Attributes:
        frame: 1, 2, ...
        observation: what the robot sensed.
        truths: what was true, by camera that took an image at this instant; those of other cameras than
            `thermal` are made when first asked for, which must be before the next tick.
        tracks: what the tracker made of the images.
        explanation: its explanation beyond its tracks, to be drawn by its type; None for nothing.
        mode: what the behaviour was doing, such as "search" or "follow".
        command: the robot's next command.
        reason: why the behaviour was doing that.
        following: number of the track that the robot follows; None if it follows nobody.
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

    @property
    def truth(self) -> Truth:
        """What was true, boxes and masks in the thermal image."""
        return self.truths["thermal"]


class Stage(Protocol):
    """Where the robot is: a world, or one whose sensors have faults."""

    def observe(self) -> Observation:
        """Read every sensor once."""
        ...

    @property
    def cameras(self) -> Mapping[str, CameraConfig]:
        """What the robot carries, by name."""
        ...

    def truths(self) -> Mapping[str, Truth]:
        """Return what is true at this instant, by camera that takes an image."""
        ...

    def step(self, linear_m_s: float, angular_rad_s: float, *, is_emergency: bool = False) -> None:
        """Drive the robot for one control step."""
        ...


class TrackerDown(RuntimeError):  # noqa: N818
    """A tracker is out of order, which the robot is to get over: it drives on without anybody in sight."""


class Perception:
    """The tracker, and whether what it says can be relied on: images may stay out, and it may be down.

    Attributes:
        tracks: those of the newest image that was understood.
    """

    def __init__(self, tracker: Tracker, calibrations: Mapping[str, Calibration]) -> None:
        self._tracker = tracker
        self._calibrations = calibrations
        self._watched = tuple(dict.fromkeys((THERMAL, *tracker.cameras)))
        self._newest: Observation | None = None
        self._images: Images = {}
        self.tracks: tuple[Track, ...] = ()

    def perceive(self, observation: Observation) -> Percept:
        """Let the tracker see the images if they are new, and tell the behaviour.

        Images equal to the last ones to the bit are no new ones: the noise of a camera never repeats. Before
        a wall colder than the thermal camera's span there is none, though: an image of one grey may be new.
        """
        newest = self._newest
        tell = partial(
            make_percept,
            observation,
            self._calibrations[THERMAL],
            knows_again=knows_again(self._tracker),
        )
        images = {name: observation.images[name] for name in self._watched if name in observation.images}
        if newest is not None and _are_same(self._images, images):
            return tell(self.tracks, image_age_s=observation.time_s - newest.time_s)
        before = None if newest is None else newest.odometry
        self._newest, self._images = observation, images
        try:
            self.tracks = self._tracker.update(
                Frame.from_observation(observation, before, self._calibrations)
            )
        except TrackerDown as error:  # a robot among people outlives its tracker
            self.tracks = ()
            return tell((), fault=f"the tracker failed: {error}")
        return tell(self.tracks)


def closed_loop(
    world: Stage, tracker: Tracker | str, behaviour: Behaviour | str, frames: int
) -> Iterator[Tick]:
    """Run the loop for a number of frames, from the world's present instant on.

    Args:
        world: such as `World("crossing_2")`.
        tracker: a tracker, or the name of one, made with seed 0.
        behaviour: a behaviour, or the name of one.
        frames: how many, at 15 a second.

    Raises:
        BadInput: tracker or behaviour gave what cannot be used; it is said at which frame.
        OwnCodeFailed: one that is checked failed.
    """
    tracker = make_tracker(tracker) if isinstance(tracker, str) else tracker
    behaviour = make_behaviour(behaviour) if isinstance(behaviour, str) else behaviour
    perception = Perception(tracker, calibrations_of(world.cameras))
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
            )
        yield tick
        if frame < frames:
            world.step(command.linear_m_s, command.angular_rad_s, is_emergency=command.is_emergency)


def make_percept(
    observation: Observation,
    thermal: Calibration,
    tracks: tuple[Track, ...],
    *,
    image_age_s: float = 0.0,
    knows_again: bool = False,
    fault: str = "",
) -> Percept:
    """Return the behaviour what it steers by: confirmed tracks, sonar and the wheels' speed."""
    height, width = observation.images[THERMAL].shape
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
        images=observation.images,
        image_age_s=image_age_s,
        knows_again=knows_again,
        fault=fault,
    )


def _are_same(old: Images, new: Images) -> bool:
    are_equal = all(name in old and np.array_equal(old[name], image) for name, image in new.items())
    return are_equal and any(image.min() < image.max() for image in new.values())


def see_person(track: Track, box: Box, width: int, height: int) -> SeenPerson:
    """Express a track's box [px] in shares of the image."""
    shares = image_shares(box, width, height)
    return SeenPerson(
        id=track.id,
        x=shares.x,
        height=shares.height,
        top=shares.top,
        bottom=shares.bottom,
        confidence=track.confidence,
        is_visible=track.status is not Status.TOTALLY_OCCLUDED,
    )
