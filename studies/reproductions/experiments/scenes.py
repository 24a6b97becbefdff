"""Score scene models on sequences with moved objects: backgrounds, masks and events."""

import base64
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.pose2 import Pose2
from peopleboy.random_streams import stream
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.finished_runs.run_frames import IMAGES
from peopleboy.scenarios.finished_runs.true_events import PersonNames, TrueEvent, matching
from peopleboy.scenarios.running.engine.store import Result
from peopleboy.sim.truth.events import ThingLog
from peopleboy.sim.truth.truth import Backgrounds, Truth
from peopleboy.studies.reproductions.experiment import Line, Row, Samples, as_columns, mean, ratio
from peopleboy.studies.reproductions.experiments.playback import Stopwatch, play
from peopleboy.studies.reproductions.plan import PRESETS, SEQUENCES
from peopleboy.studies.reproductions.scene_model.printed_config import VARIANTS
from peopleboy.studies.reproductions.scene_model.printed_model import PrintedSceneModel
from peopleboy.studies.reproductions.units import Measurement, Unit
from peopleboy.tracker.frame import DEPTH, Frame
from peopleboy.tracker.scene_model.geometry import Geometry
from peopleboy.tracker.scene_model.scene import Happening, Metres, VistaScene
from peopleboy.tracker.scene_model.scene_config import PeopleMaskConfig, SceneConfig
from peopleboy.tracker.scene_model.scene_model import SceneModel

Bools = NDArray[np.bool_]
Floats = NDArray[np.float32]

TOF: Final = PRESETS[0]
"""Depth camera of all models; the best models also run on other cameras."""
CHAIRS: Final = ("s2r1", "s2r2")
"""Sequences with chairs, whose thin legs no depth sensor resolves well."""
SHOWN: Final = ("s1r1", "s2r1", "s3r1", "s4r1", "s5r1", "s6r1")
"""Sequences of which the backgrounds of seed 0 are stored."""
ALL: Final = "all"

MEAN, MPIX, TRACK, ADAPT = "MEAN", "MPIX", "TRACK", "ADAPT"
"""Models as printed."""
TRUE_PEOPLE: Final = "ADAPT, true people"
"""ADAPT with the true pixels of people instead of those of tracked ellipses."""
_EDGE: Final = np.ones((5, 5), np.uint8)  # margin around true people, for mixed and smoothed readings
ROBUST, NO_HEAT = "robust", "robust, without heat"
"""PeopleBoy's own model, with and without the thermal image."""
PRINTED: Final = (MEAN, MPIX, TRACK, ADAPT)
OURS: Final = (ROBUST, NO_HEAT)

EVERY: Final = 5
"""Interval between the frames whose masks are compared."""
LEAST_M: Final = 0.12
"""Minimum distance [m] of an object in front of the background."""
EVER, CLEAN = "ever", "clean"
_FARTHEST_M: Final = 65.0  # limit of a map: 16 bits hold 65.5 m in millimetres


def static_scenes(using: Measurement) -> Samples:
    """Measure the error of each model's static scene, sequence by sequence (table 3.1)."""
    scenes = using.plan.scenes
    found = using.played(watch_scene, scenes, using.plan.scene_seeds, TOF)
    return {
        Line(group, model): as_columns(
            {
                f"{kind} [mm]": mean([run[model][CLEAN][kind] for run in runs])
                for kind in ("mean", "deviation")
            }
            for runs in zip(*(found[name] for name in names), strict=True)
        )
        for group, names in ({name: (name,) for name in scenes} | {ALL: scenes}).items()
        for model in (*PRINTED, ROBUST)
    }


def scene_models(using: Measurement) -> Samples:
    """Score background, objects, people and events by depth camera, chairs separately."""
    plan, result = using.plan, {}
    using.results(
        Unit.of(watch_scene, name, seed, preset)
        for preset in plan.presets
        for name in plan.scenes
        for seed in range(plan.scene_seeds)
    )
    for preset in plan.presets:
        for is_chair, group in ((False, preset), (True, f"{preset}, chairs")):
            names = [name for name in plan.scenes if (name in CHAIRS) == is_chair]
            found = using.played(watch_scene, names, plan.scene_seeds, preset)
            for model in (ADAPT, TRUE_PEOPLE, *OURS) if names else ():
                rows = (_scene_scores(runs, model) for runs in zip(*found.values(), strict=True))
                result[Line(group, model)] = as_columns(rows)
    return result


def _scene_scores(runs: Sequence[Result], model: str) -> Row:
    """Return a model's scores; counts are summed over all runs."""
    own = [run[model] for run in runs]
    events = {name: sum(run["events"][name] for run in own) for name in own[0]["events"]}
    people, things = (np.sum([run[kind] for run in own], axis=0) for kind in ("people", "things"))
    precision = ratio(events["right"], events["right"] + events["false"])
    recall = ratio(events["told"], events["events"])
    return {
        "mean [mm]": mean([run[EVER]["mean"] for run in own]),
        "median pixel [mm]": mean([run[EVER]["median"] for run in own]),
        "known": mean([run[EVER]["known"] for run in own]),
        "better than MEAN": mean([run[model][CLEAN]["mean"] < run[MEAN][CLEAN]["mean"] for run in runs]),
        "events F1": ratio(2.0 * precision * recall, precision + recall),
        "moved by": ratio(events["named"], events["asked"]),
        "things P": ratio(things[0], things[0] + things[1]),
        "things R": ratio(things[0], things[0] + things[2]),
        "people P": ratio(people[0], people[0] + people[1]),
        "people R": ratio(people[0], people[0] + people[2]),
        "ms": mean([run["ms"] for run in own]),
    }


def make_model(name: str) -> SceneModel | PrintedSceneModel:
    """Create a scene model, one of `PRINTED` or `OURS`, or `TRUE_PEOPLE`."""
    if name in (*PRINTED, TRUE_PEOPLE):
        variant = ADAPT if name == TRUE_PEOPLE else name
        return PrintedSceneModel(VARIANTS[variant.lower()], stream(0, "scene.particles"))
    return SceneModel(SceneConfig(people=PeopleMaskConfig(has_heat=name != NO_HEAT)))


def with_preset(scenario: Scenario, preset: str) -> Scenario:
    """Return a robot with a depth camera of a preset."""
    return scenario.with_cameras({DEPTH: {"kind": DEPTH, "preset": preset}})


class _Watcher:
    """A scene model with its results, score and time."""

    def __init__(self, name: str) -> None:
        self._name, self._model = name, make_model(name)
        self.timed = Stopwatch()
        self.scene: VistaScene | None = None
        self.happenings: list[Happening] = []
        self.identities = PersonNames()
        self.pixels = {kind: np.zeros(3, np.int64) for kind in ("people", "things")}

    def update(self, frame: Frame, masks: Mapping[str, Bools], truth: Truth) -> None:
        update: Callable[[], VistaScene] = partial(self._model.update, frame)
        if self._name == TRUE_PEOPLE and isinstance(self._model, PrintedSceneModel):
            people_px = cv2.dilate((truth.instance > 0).astype(np.uint8), _EDGE) > 0
            update = partial(self._model.update, frame, people_px)
        scene = self.scene = self.timed(update)
        people = [(one.name, truth.robot.to_local(one.position_m)) for one in truth.people]
        self.identities.look([(one.id, one.place_m) for one in scene.persons], people)
        self.happenings += scene.happenings
        for kind, mask in masks.items():
            self.pixels[kind] += count_pixels((getattr(scene, kind) > 0) & (frame.depth(DEPTH) > 0), mask)

    def plain(
        self, true: Mapping[str, Metres], lengths: Floats, events: Sequence[TrueEvent], robot: Pose2
    ) -> dict[str, Any]:
        """Finish, and return errors, pixels, events and time as plain data."""
        self.happenings += self._model.finish()
        assert self.scene is not None  # at least one frame was processed
        background = self.scene.background_m
        return {
            **{name: background_errors(background, depth, lengths) for name, depth in true.items()},
            **{kind: sums.tolist() for kind, sums in self.pixels.items()},
            "events": event_counts(self.happenings, events, self.identities, robot),
            "ms": round(self.timed.median_ms, 2),
        }


def watch_scene(sequence: str, seed: int, preset: str) -> Result:
    """Play one of `SEQUENCES` once for a depth camera, and run models on it.

    Returns:
        Plain data by the model's name: errors of its background, relative to what was ever visible, and to
        the place without people and objects; pixels, events, and milliseconds. With seed 0 of `SHOWN`
        sequences also "maps", the backgrounds.

    Raises:
        BadInput: the scenario has no frames.
    """
    scenario = with_preset(load_scenario(SEQUENCES[sequence]), preset)
    names = (*PRINTED, TRUE_PEOPLE, *OURS) if preset == TOF else (MEAN, ADAPT, TRUE_PEOPLE, *OURS)
    watchers = {name: _Watcher(name) for name in names}
    backgrounds, log, events = Backgrounds(), ThingLog(), list[TrueEvent]()
    last = None
    for last in play(scenario, seed, DEPTH, images=IMAGES):
        backgrounds.update(last.truth)
        events += _new_events(log, last.truth)
        is_compared = (last.number - 1) % EVERY == 0
        masks = _true_masks(last.truth, backgrounds, last.frame) if is_compared else {}
        for watcher in watchers.values():
            watcher.update(last.frame, masks, last.truth)
    if last is None or backgrounds.ever is None or backgrounds.clean is None:
        raise BadInput(f"{scenario.name}: has no frames")
    lengths = np.linalg.norm(Geometry.of(last.frame).rays, axis=2)
    true = {EVER: backgrounds.ever, CLEAN: backgrounds.clean}
    found = {name: one.plain(true, lengths, events, last.truth.robot) for name, one in watchers.items()}
    keeps_maps = preset == TOF and seed == 0 and sequence in SHOWN
    return found | ({"maps": _maps(watchers, true)} if keeps_maps else {})


def _new_events(log: ThingLog, truth: Truth) -> list[TrueEvent]:
    places = {thing.name: thing.position_m[:2] for thing in truth.things}
    return [TrueEvent.of(one, one.thing, one.by, places[one.thing]) for one in log.update(truth)]


def _true_masks(truth: Truth, backgrounds: Backgrounds, frame: Frame) -> dict[str, Bools]:
    """Return masks (H, W) of people, and of movable objects in front of the background, in depth."""
    assert backgrounds.ever is not None  # the visible background includes this frame
    is_thing = truth.owners.mask(*(thing.name for thing in truth.things))
    stands_clear = backgrounds.ever - truth.depth_m > LEAST_M
    is_read = frame.depth(DEPTH) > 0
    return {"people": (truth.instance > 0) & is_read, "things": is_thing & stands_clear & is_read}


def count_pixels(found: Bools, wanted: Bools) -> NDArray[np.int64]:
    """Return the numbers (3,) of correct, false and missed pixels."""
    right = int(np.count_nonzero(found & wanted))
    return np.array([right, np.count_nonzero(found) - right, np.count_nonzero(wanted) - right])


def background_errors(found_m: Metres, true_m: Metres, lengths: Floats) -> dict[str, float]:
    """Compare a background (H, W) [m] with ground truth, which is infinite without a surface.

    Args:
        found_m: estimated depth; 0 where unknown.
        true_m: depth along the optical axis.
        lengths: (H, W) length of each pixel's ray of depth 1.

    Returns:
        Distance of the points [mm]: mean, deviation and median; and the share of known pixels.
    """
    is_known = (found_m > 0.0) & np.isfinite(true_m)
    off = 1000.0 * np.abs(found_m - true_m)[is_known] * lengths[is_known]
    share = float(is_known.sum() / max(np.isfinite(true_m).sum(), 1))
    measures: dict[str, Callable[[Floats], Any]] = {"mean": np.mean, "deviation": np.std, "median": np.median}
    errors = {name: float(measure(off)) if off.size else float("nan") for name, measure in measures.items()}
    return errors | {"known": share}


def event_counts(
    happenings: Sequence[Happening], events: Sequence[TrueEvent], identities: PersonNames, first: Pose2
) -> dict[str, int]:
    """Count correct and false detected events, true and found events, and the people who caused them.

    A detected event is correct if a true event matches it in time and place, and that event counts as found.
    The person is scored if a person caused the event, and it was found.
    """
    found = matching(happenings, events, first)
    predicted = {n: k for k, numbers in sorted(found.items(), reverse=True) for n in numbers}
    asked = {n: k for n, k in predicted.items() if events[n].by}
    named = sum(identities.name(happenings[k].person) == events[n].by for n, k in asked.items())
    return {
        "right": len(found),
        "false": len(happenings) - len(found),
        "events": len(events),
        "told": len(predicted),
        "asked": len(asked),
        "named": named,
    }


def _maps(watchers: Mapping[str, _Watcher], true: Mapping[str, Metres]) -> dict[str, str]:
    """Return depths as 16-bit PNG files in millimetres, in base 64."""
    depths = {name: one.scene.background_m for name, one in watchers.items() if one.scene is not None}
    return {name: _encoded(depth) for name, depth in (depths | dict(true)).items()}


def _encoded(depth_m: Metres) -> str:
    known_m = np.where(np.isfinite(depth_m), np.minimum(depth_m, _FARTHEST_M), 0.0)
    image = np.rint(1000.0 * known_m).astype(np.uint16)
    return base64.b64encode(cv2.imencode(".png", image)[1].tobytes()).decode()


def read_map(encoded: str) -> Metres:
    """Read a background (H, W) [m]; 0 where nothing is known."""
    image = cv2.imdecode(np.frombuffer(base64.b64decode(encoded), np.uint8), cv2.IMREAD_UNCHANGED)
    assert image is not None
    return np.asarray(image, np.float32) / np.float32(1000.0)
