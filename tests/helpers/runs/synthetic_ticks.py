"""Ticks of a small made-up run: two people, one of whom walks behind the other, and one track."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from peopleboy.behaviours.behaviour import Command
from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.loop.run_events import LogLine
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.observation import Observation
from peopleboy.sim.people.person_config import PersonConfig, Waypoint
from peopleboy.sim.places.make_place import build_place
from peopleboy.sim.places.place_config import straight_corridor
from peopleboy.sim.truth.truth import Owners, PersonTruth, Truth
from peopleboy.sim.world_config import WorldConfig
from peopleboy.tracker.reproductions.contour.explanation import DETECTOR_KEY, ContourExplanation, Ellipse
from peopleboy.tracker.reproductions.contour.particles import Particles
from peopleboy.tracker.reproductions.contour.variants import CONTOUR
from peopleboy.tracker.track import Status, Track

CAMERA = Pinhole()
ELLIPSE = Ellipse(x=160.0, y=120.0, w=20.0, h=50.0, d=3.0, vx=0.0, vy=0.0, vw=0.0, vh=0.0)
TRACK = Track(
    id=1, boxes={"thermal": (140.0, 47.3, 40.0, 175.0)}, confidence=0.9, status=Status.TRACKED, age_s=1.0,
)  # fmt: skip


def config() -> WorldConfig:
    """A corridor with two people."""
    people = tuple(
        PersonConfig(name=name, path=(Waypoint(at_m=(x, 0.0)),)) for name, x in (("anna", 4.0), ("ben", 6.0))
    )
    return WorldConfig(place=build_place(straight_corridor(10.0, 3.0)), people=people)


def joints(x: float, y: float) -> NDArray[np.float64]:
    """(17, 3) [m] of somebody standing straight and facing the robot."""
    height = (
        1.65,
        1.68,
        1.68,
        1.66,
        1.66,
        1.45,
        1.45,
        1.15,
        1.15,
        0.9,
        0.9,
        0.92,
        0.92,
        0.5,
        0.5,
        0.08,
        0.08,
    )
    side = (
        0.0,
        0.03,
        -0.03,
        0.07,
        -0.07,
        0.2,
        -0.2,
        0.22,
        -0.22,
        0.22,
        -0.22,
        0.1,
        -0.1,
        0.1,
        -0.1,
        0.1,
        -0.1,
    )
    return np.stack([np.full(17, x), y + np.array(side), np.array(height)], axis=1)


def person(number: int, name: str, x: float, hidden: float = 0.0) -> PersonTruth:
    """Somebody x metres ahead, a share of whom the other hides."""
    return PersonTruth(
        id=number, name=name, position_m=(x, 0.0), heading_rad=math.pi, velocity_m_s=(0.0, 0.0),
        posture="standing", distance_m=x, is_counted=True, box=(140.0, 50.0, 40.0, 170.0),
        whole_box=(138.0, 50.0, 44.0, 170.0), visible_box=(138.0, 50.0, 44.0, 170.0), whole_px=5000,
        visible_px=round(5000 * (1.0 - hidden)), visible_fraction=1.0 - hidden,
        hidden_by={"anna": hidden} if hidden > 0.0 else {}, part_temperature_c={},
        joints_m=joints(x, 0.0), joints_px=np.zeros((17, 2)), joint_is_visible=np.ones(17, np.bool_),
    )  # fmt: skip


def explain(tracks: Sequence[Track] = (TRACK,), cloud: Particles | None = None) -> ContourExplanation:
    """What the contour tracker says of such tracks; every filter has the same cloud."""
    clouds = {} if cloud is None else {DETECTOR_KEY: cloud, **{track.id: cloud for track in tracks}}
    return ContourExplanation(
        config=CONTOUR,
        ellipses={track.id: ELLIPSE for track in tracks},
        spread_px2={track.id: 10.0 for track in tracks},
        particles=clouds,
    )


def make_tick(frame: int, track: Track | None = TRACK, hidden: float = 0.0, mode: str = "follow") -> Tick:
    """One tick; ben is there until frame 60."""
    rng = np.random.default_rng(frame)
    time_s = (frame - 1) / 15.0
    people = (person(1, "anna", 4.0),) + ((person(2, "ben", 6.0, hidden),) if frame < 60 else ())
    thermal = np.zeros((240, 320), np.uint8)
    thermal[60:220, 140:180] = 150
    state = np.float32(rng.normal((160, 120, 20, 50, 3, 0, 0, 0, 0), 3.0, (300, 9)))
    cloud = Particles(state, np.float32(np.full(300, 1 / 300)))
    images = {
        "thermal": thermal, "thermal_c": np.zeros((240, 320), np.float32), "thermal_scene": thermal,
        "colour": rng.integers(90, 110, (30, 40, 3), np.uint8).repeat(8, axis=0).repeat(8, axis=1),
    }  # fmt: skip
    observation = Observation(
        time_s=time_s, images=images, sonar_m=np.full(16, 5.0),
        odometry=Pose2(0.0, 0.0, 0.0), wheel_speeds_m_s=(0.0, 0.0),
    )  # fmt: skip
    truth = Truth(
        time_s=time_s, people=people, instance=np.zeros((240, 320), np.uint8),
        body_part=np.zeros((240, 320), np.uint8), depth_m=np.ones((240, 320), np.float32), camera=CAMERA,
        world_from_camera=np.eye(4), robot=Pose2(0.01 * frame, 0.0, 0.1),
        robot_velocity=(0.2, 0.1), contacts=(), things=(),
        owners=Owners((), np.array([-1], np.int16), np.full((240, 320), -1, np.int32)),
        background_m=lambda: np.ones((240, 320), np.float32),
    )  # fmt: skip
    return Tick(
        frame=frame, observation=observation, truths={"thermal": truth, "colour": truth},
        tracks=() if track is None else (track,),
        explanation=explain(() if track is None else (track,), cloud), mode=mode,
        command=Command(linear_m_s=0.3, angular_rad_s=0.0),
    )  # fmt: skip


def make_run(frames: int = 75) -> list[tuple[Tick, list[LogLine]]]:
    """A run: detected at frame 5, ben hidden from 20 to 40 and most at 30, lost at 70."""
    kinds = {
        1: [("mode", "robot", "search")],
        5: [("detected", "track 1", ""), ("mode", "robot", "follow")],
        20: [("occlusion starts", "ben", "anna")],
        40: [("occlusion ends", "ben", "anna")],
        70: [("lost", "track 1", "")],
    }
    run = []
    for frame in range(1, frames + 1):
        hidden = max(0.0, 0.95 - 0.09 * abs(frame - 30)) if 20 <= frame < 40 else 0.0
        track = TRACK if 5 <= frame < 70 else None
        tick = make_tick(frame, track, hidden, "search" if frame < 5 else "follow")
        time_s = tick.observation.time_s
        events = [
            LogLine(frame=frame, time_s=time_s, kind=kind, who=who, other=other)
            for kind, who, other in kinds.get(frame, [])
        ]
        run.append((tick, events))
    return run


def with_box(box: tuple[float, float, float, float]) -> Track:
    """The track, elsewhere."""
    return replace(TRACK, boxes={"thermal": box})


def with_status(status: Status) -> Track:
    """The track, otherwise."""
    return replace(TRACK, status=status)
