"""Letting scene models watch a film in which things are moved, all of them the same images."""

from __future__ import annotations

import base64
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Final, Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.calibrations import calibrations_of
from peopleboy.scenarios.loop.loop import make_frame
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.scenarios.watching.run_frames import IMAGES
from peopleboy.scenarios.watching.true_events import TrueEvent, WhoIsWho, matching
from peopleboy.sim.geometry.planar import Planar
from peopleboy.sim.random_streams import stream
from peopleboy.sim.truth.backgrounds import Backgrounds
from peopleboy.sim.truth.events import ThingLog
from peopleboy.sim.truth.truth import Truth
from peopleboy.studies.reproductions.evaluations.playback import with_cameras
from peopleboy.tracker.frame import DEPTH, Frame
from peopleboy.tracker.scene_model.geometry import Geometry
from peopleboy.tracker.scene_model.printed.printed_config import VARIANTS, PrintedConfig
from peopleboy.tracker.scene_model.printed.printed_model import PrintedSceneModel
from peopleboy.tracker.scene_model.scene import Happening, Metres, VistaScene
from peopleboy.tracker.scene_model.scene_config import PeopleMaskConfig, SceneConfig
from peopleboy.tracker.scene_model.scene_model import SceneModel

# How right a scene model is: its background, its masks of people and things, and what it tells.

Bools = NDArray[np.bool_]
Floats = NDArray[np.float32]

LEAST_M: Final = 0.12
"""[m] before what is behind it from which on something is to be found."""


@dataclass(frozen=True, slots=True, eq=False)
class TrueMasks:
    """What is truly seen in an image, where the camera reads anything.

    Attributes:
        people: (H, W) people.
        things: (H, W) movable things that stand clear of what was shown behind them.
        is_read: (H, W) where there is a reading.
    """

    people: Bools
    things: Bools
    is_read: Bools


class SceneScore:
    """Counts pixels frame by frame, and takes up what is told."""

    def __init__(self) -> None:
        self._pixels = {kind: np.zeros(3, np.int64) for kind in ("people", "things")}
        self.happenings: list[Happening] = []
        self.who = WhoIsWho()

    def add(self, scene: VistaScene, truth: TrueMasks) -> None:
        """Take in a frame."""
        for kind, found, wanted in (
            ("people", scene.people > 0, truth.people),
            ("things", scene.things > 0, truth.things),
        ):
            self._pixels[kind] += counts(found & truth.is_read, wanted & truth.is_read)
        self.happenings += scene.happenings

    def plain(self) -> dict[str, Any]:
        """Give right, false and missed pixels, by kind."""
        return {kind: sums.tolist() for kind, sums in self._pixels.items()}


def counts(found: Bools, wanted: Bools) -> NDArray[np.int64]:
    """Count (3,) right, false and missed pixels."""
    right = int(np.count_nonzero(found & wanted))
    return np.array([right, np.count_nonzero(found) - right, np.count_nonzero(wanted) - right])


def background_errors(found_m: Metres, true_m: Metres, lengths: Floats) -> dict[str, float]:
    """Compare a background (H, W) [m] with the truth, which is infinite where there is nothing.

    Args:
        found_m: 0 where nothing is known.
        true_m: depth along the optical axis.
        lengths: (H, W) length of each pixel's ray of depth 1.

    Returns:
        Distance of the points [mm]: mean, deviation and median; and the share of pixels that are known.
    """
    is_known = (found_m > 0.0) & np.isfinite(true_m)
    off = 1000.0 * np.abs(found_m - true_m)[is_known] * lengths[is_known]
    share = float(is_known.sum() / max(np.isfinite(true_m).sum(), 1))
    if not off.size:
        return {"mean": float("nan"), "deviation": float("nan"), "median": float("nan"), "known": share}
    return {
        "mean": float(off.mean()),
        "deviation": float(off.std()),
        "median": float(np.median(off)),
        "known": share,
    }


def event_counts(
    happenings: Sequence[Happening], events: Sequence[TrueEvent], who: WhoIsWho, first: Planar
) -> dict[str, int]:
    """Count what was told rightly and falsely, what truly happened and was told, and who did it.

    A happening is right if something happened there then; what truly happened is told if there is such a
    happening. Who did it counts where somebody did, and it was told.
    """
    found = matching(happenings, events, first)
    told = {n: k for k, numbers in sorted(found.items(), reverse=True) for n in numbers}
    asked = {n: k for n, k in told.items() if events[n].by}
    named = sum(who.name(happenings[k].person) == events[n].by for n, k in asked.items())
    return {
        "right": len(found),
        "false": len(happenings) - len(found),
        "events": len(events),
        "told": len(told),
        "asked": len(asked),
        "named": named,
    }


# The scene models that are compared, by name.

MEAN, MPIX, TRACK, ADAPT = "MEAN", "MPIX", "TRACK", "ADAPT"
"""As printed."""

ROBUST, NO_HEAT = "robust", "robust, without heat"
"""Ours, and ours without the thermal image."""

PRINTED: Final = (MEAN, MPIX, TRACK, ADAPT)
OURS: Final = (ROBUST, NO_HEAT)


class Watches(Protocol):
    """Whatever turns frames into scenes."""

    def update(self, frame: Frame) -> VistaScene:
        """Take in the next frame."""
        ...

    def finish(self) -> tuple[Happening, ...]:
        """Tell what was held back."""
        ...


def _printed(config: PrintedConfig) -> Watches:
    return PrintedSceneModel(config, stream(0, "scene.particles"))


def _robust(config: SceneConfig) -> Watches:
    return SceneModel(config)


CHOICES: Final[dict[str, Callable[[], Watches]]] = {
    **{name: partial(_printed, VARIANTS[name.lower()]) for name in PRINTED},
    ROBUST: partial(_robust, SceneConfig()),
    NO_HEAT: partial(_robust, SceneConfig(people=PeopleMaskConfig(has_heat=False))),
}


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


# The sequences of the thesis's chapter 3, and the scenarios that stand for them.

SEQUENCES: Final[Mapping[str, str]] = {
    **{f"s1r{k}": f"bears_{k}" for k in range(1, 7)},
    **{f"s2r{k}": f"chairs_{k}" for k in (1, 2)},
    **{f"s3r{k}": f"tidying_{k}" for k in (1, 2)},
    **{f"s4r{k}": f"doors_{k}" for k in range(1, 5)},
    **{f"s5r{k}": f"cans_{k}" for k in (1, 2)},
    "s6r1": "plants_1",
}
"""Scenarios by the name of the sequence: bears rearranged, chairs moved, tidying up, doors, cans, plants."""

CHAIRS: Final = ("s2r1", "s2r2")
"""Sequences whose thin legs no sensor of these sees well."""

PRESETS: Final = ("tof", "kinect", "kinect_rough")
"""Depth cameras that watch them."""
