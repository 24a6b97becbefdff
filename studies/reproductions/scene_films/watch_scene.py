"""Letting scene models watch a film in which things are moved, all of them the same images."""

from __future__ import annotations

import base64
import time
from collections.abc import Iterable
from typing import Any, Final

import cv2
import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.calibrations import calibrations_of
from peopleboy.scenarios.loop.loop import make_frame
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.scenarios.watching.run_frames import IMAGES
from peopleboy.scenarios.watching.true_events import TrueEvent
from peopleboy.sim.geometry.planar import Planar
from peopleboy.sim.truth.backgrounds import Backgrounds
from peopleboy.sim.truth.thing_events import ThingLog
from peopleboy.sim.truth.truth import Truth
from peopleboy.studies.reproductions.depth_drives.play_drive import with_cameras
from peopleboy.studies.reproductions.scene_films.scene_choices import CHOICES
from peopleboy.studies.reproductions.scene_films.score_scene import (
    LEAST_M,
    SceneScore,
    TrueMasks,
    background_errors,
    event_counts,
)
from peopleboy.tracker.frame import DEPTH, Frame
from peopleboy.tracker.scene_model.geometry import Geometry
from peopleboy.tracker.scene_model.scene import Metres, VistaScene

EVERY: Final = 5
"""So-manieth frame whose masks are compared."""

EVER, CLEAN = "ever", "clean"


class _Watcher:
    """One model, its score, and how long it takes."""

    def __init__(self, name: str) -> None:
        self._model = CHOICES[name]()
        self.score = SceneScore()
        self.scene: VistaScene | None = None
        self.times_ms: list[float] = []

    def see(self, frame: Frame, masks: TrueMasks | None, truth: Truth) -> None:
        start = time.process_time()
        self.scene = self._model.update(frame)
        self.times_ms.append(1000.0 * (time.process_time() - start))
        people = [(one.name, truth.robot.locate(one.position_m)) for one in truth.people]
        self.score.who.look([(one.id, one.place_m) for one in self.scene.persons], people)
        if masks is None:
            self.score.happenings += self.scene.happenings
        else:
            self.score.add(self.scene, masks)

    def finish(self) -> None:
        self.score.happenings += self._model.finish()


def with_preset(scenario: Scenario, preset: str) -> Scenario:
    """Give the robot a depth camera by the name of its preset."""
    return with_cameras(scenario, {DEPTH: {"kind": DEPTH, "preset": preset}})


def watch_scene(
    scenario: Scenario, seed: int, names: Iterable[str], *, keeps_maps: bool = False
) -> dict[str, Any]:
    """Play a film once, and let models watch it.

    Args:
        scenario: whose robot stands and has a depth camera.
        seed: of the run.
        names: of the models.
        keeps_maps: whether to give the backgrounds, too.

    Returns:
        Plain data by the model's name: errors of its background, held against what was ever shown, and
        against the place without people and things; pixels, events, and milliseconds.
    """
    watchers = {name: _Watcher(name) for name in names}
    backgrounds, log, events = Backgrounds(), ThingLog(), list[TrueEvent]()
    calibrations = calibrations_of(scenario.world(seed).robot.cameras)
    before: Planar | None = None
    frame = None
    for number, (world, observation) in enumerate(blind_drive(scenario, seed)):
        truth = world.truth(DEPTH)
        backgrounds.update(truth)
        events += _new_events(log, truth)
        frame = make_frame(observation, calibrations, before)
        before = observation.odometry
        for name in IMAGES:
            frame.images.get(name)  # images are made when first asked for, which is not to count as time
        masks = _true_masks(truth, backgrounds, frame) if number % EVERY == 0 else None
        for watcher in watchers.values():
            watcher.see(frame, masks, truth)
    if frame is None or backgrounds.ever is None or backgrounds.clean is None:
        raise BadInput(f"{scenario.name}: has no frames")
    lengths = np.linalg.norm(Geometry.of(frame).rays, axis=2)
    true = {EVER: backgrounds.ever, CLEAN: backgrounds.clean}
    found = {name: _plain(one, true, lengths, events, truth.robot) for name, one in watchers.items()}
    return found | ({"maps": _maps(watchers, true)} if keeps_maps else {})


def _plain(
    one: _Watcher, true: dict[str, Metres], lengths: Metres, events: list[TrueEvent], robot: Planar
) -> dict[str, Any]:
    one.finish()
    assert one.scene is not None  # there was a frame
    background = one.scene.background_m
    return {
        **{name: background_errors(background, depth, lengths) for name, depth in true.items()},
        **one.score.plain(),
        "events": event_counts(one.score.happenings, events, one.score.who, robot),
        "ms": round(float(np.median(one.times_ms)), 2),
    }


def _new_events(log: ThingLog, truth: Truth) -> list[TrueEvent]:
    places = {thing.name: thing.position_m[:2] for thing in truth.things}
    return [TrueEvent.of(one, one.thing, one.by, places[one.thing]) for one in log.update(truth)]


def _true_masks(truth: Truth, backgrounds: Backgrounds, frame: Frame) -> TrueMasks:
    assert backgrounds.ever is not None  # it has taken in this truth
    is_thing = truth.owners.mask(*(thing.name for thing in truth.things))
    stands_clear = backgrounds.ever - truth.depth_m > LEAST_M
    return TrueMasks(truth.instance > 0, is_thing & stands_clear, frame.depth(DEPTH) > 0)


def _maps(watchers: dict[str, _Watcher], true: dict[str, Metres]) -> dict[str, str]:
    """Give depths as 16-bit PNG files in millimetres, in letters."""
    depths = {name: one.scene.background_m for name, one in watchers.items() if one.scene is not None} | true
    return {name: _letters(depth) for name, depth in depths.items()}


def _letters(depth_m: Metres) -> str:
    image = np.rint(1000.0 * np.where(np.isfinite(depth_m), np.minimum(depth_m, 65.0), 0.0)).astype(np.uint16)
    return base64.b64encode(cv2.imencode(".png", image)[1].tobytes()).decode()


def read_map(letters: str) -> Metres:
    """Read a background (H, W) [m]; 0 where nothing is known."""
    image = cv2.imdecode(np.frombuffer(base64.b64decode(letters), np.uint8), cv2.IMREAD_UNCHANGED)
    assert image is not None
    return np.asarray(image, np.float32) / np.float32(1000.0)
