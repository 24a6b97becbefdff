"""Run one scenario: build its world, run the closed loop, record it, and write its folder."""

import logging
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from peopleboy.bad_input import BadInput
from peopleboy.behaviours.behaviour import STOP, Command
from peopleboy.own_code import traceback_in
from peopleboy.scenarios.drawing.contact_sheet import ContactSheet
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.own_files import are_kept, keep_own_files
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.files.scenario_file import FaultSpec
from peopleboy.scenarios.loop.faults import FaultySensors, FaultyTracker
from peopleboy.scenarios.loop.loop import Tick, closed_loop
from peopleboy.scenarios.loop.run_events import LogLine, RunEvents
from peopleboy.scenarios.loop.tracker_by_name import check_cameras, make_named_tracker, tracker_cameras
from peopleboy.scenarios.recording.recording_file import is_recorded
from peopleboy.scenarios.run_folder.atomic_output import left_by_signals
from peopleboy.scenarios.run_folder.finished_run import note_on, open_run
from peopleboy.scenarios.run_folder.folder import RunFolder, claim_folder, versions
from peopleboy.scenarios.run_folder.image_files import about_gains
from peopleboy.scenarios.run_folder.run_files import check_detections
from peopleboy.scenarios.running.gallery_file import use_gallery
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.scenarios.scores.comfort_metrics import score_comfort
from peopleboy.scenarios.scores.contacts import ContactLog
from peopleboy.scenarios.scores.corridor_metrics import legs_of, score_corridor
from peopleboy.scenarios.scores.drive_record import DriveLog, DriveRecord
from peopleboy.scenarios.scores.episode_result import DriveScores, EpisodeResult
from peopleboy.scenarios.scores.following_metrics import following_task, score_following, tracks_on_target
from peopleboy.scenarios.scores.goal_metrics import goal_task, score_goal
from peopleboy.scenarios.scores.run_scores import RunScores, score_run
from peopleboy.sim.world import SimulatedWorld
from peopleboy.sim.world_config import WorldConfig
from peopleboy.tracker.checked_tracker import CheckedTracker
from peopleboy.tracker.evaluation.latency import write_latency
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.tracker.tracker_names import shown_name, with_detector
from peopleboy.tracker.trackers import explanation_of

if TYPE_CHECKING:
    from peopleboy.scenarios.recording.recorder import Recorder
_LOG = logging.getLogger(__name__)


class RunObservers:
    """Pass each tick to the event log, the metrics, the contact sheet and, if there is one, the recorder.

    Args:
        config: settings of the world.
        title: title of the run.
        recorder: recorder of the run; None for none.
        boxes: what the tracker's boxes enclose.
        faults: faults of the scenario.
        is_secret: whether the person that the robot follows is unknown, as with recorded commands.
    """

    def __init__(
        self,
        config: WorldConfig,
        title: str,
        recorder: "Recorder | None",
        boxes: BoxKind = BoxKind.TORSO,
        *,
        faults: Sequence[FaultSpec] = (),
        is_secret: bool = False,
    ) -> None:
        self.drive = DriveLog()
        self.contacts = ContactLog()
        self._events = RunEvents(faults)
        self._sheet = ContactSheet(title, config.robot)
        self._recorder = recorder
        self._boxes = boxes
        self._is_secret = is_secret
        self._track = 0  # id of the last track on the person to follow

    def update(self, tick: Tick) -> list[LogLine]:
        """Process one tick, and return its events."""
        events = self._events.update(tick)
        track, is_wrong = tracks_on_target(tick, self._boxes, self._track)
        self._track = track or self._track
        self.drive.add(tick.truth, track, None if self._is_secret else is_wrong)
        self.contacts.add(tick.truth)
        self._sheet.add(tick, events)
        if self._recorder is not None:
            self._recorder.log(tick, events)
        return events

    def save(self, folder: Path) -> None:
        """Write the files that are drawn at the end."""
        self._sheet.save(folder / "contact_sheet.png")


FOLLOWERS = ("follow_person", "patrol")


def tracker_name(scenario: Scenario, options: RunOptions) -> str:
    """Return the name of a run's tracker, with its detector: the requested one, or the scenario's."""
    tracker = scenario.tracker if options.tracker is None else options.tracker
    return with_detector(tracker, options.detector)


def run(
    scenario: str | Path | Scenario,
    options: RunOptions | None = None,
    report: Callable[[Tick, int], None] = lambda _tick, _frames: None,
) -> RunScores:
    """Run a scenario from start to end and write its folder.

    Args:
        scenario: a library name, the path of a YAML file, or a loaded scenario.
        options: options of the run; None for the scenario's seed and the folder runs/SCENARIO-SEED.
        report: called after every tick with the total number of ticks, for example to move a progress bar.

    Returns:
        The scores, as in metrics.json.

    Raises:
        BadInput: an option is invalid, and nothing is written; or the tracker or the behaviour returned an
            invalid value, and run.json marks the run as failed.
        OwnCodeFailed: the tracker or the behaviour raised an error; run.json has the traceback.
    """
    scenario = load_scenario(scenario)
    if options is None:
        options = RunOptions(seed=scenario.seed, out=Path("runs") / f"{scenario.name}-{scenario.seed}")
    return _run(scenario, options, report, None)


def _run(
    scenario: Scenario,
    options: RunOptions,
    report: Callable[[Tick, int], None],
    episode: EpisodeResult | None,
) -> RunScores:
    """Run a scenario, or repeat an episode, whose scores are then those of the episode."""
    if options.seed < 0:
        raise BadInput(f"--seed {options.seed}: must be 0 or more")
    scenario = options.applied_to(scenario)
    world: SimulatedWorld  # the oracle accesses it only after it is built
    name, given = tracker_name(scenario, options), scenario.robot.cameras
    shown = shown_name(name)
    tracker = make_named_tracker(name, options.seed, lambda: world.truth())
    save_gallery = use_gallery(tracker, shown, options.gallery, options.out)
    scenario = scenario.mounting(tracker.cameras)
    mounted = [camera for camera in scenario.robot.cameras if camera not in given]
    config = scenario.world(options.seed, options.renderer)
    check_cameras(tracker, config.robot.cameras)
    frames = scenario.frames
    check_detections(name, frames)
    about = about_run(scenario, options, config, shown)
    about |= {"mounted_for_tracker": mounted} if mounted else {}
    about |= {} if options.gallery is None else {"gallery": options.gallery.name}
    if episode is not None:
        about["episode"] = episode.to_json()
    _LOG.info(
        "%s: seed %d, tracker %s, cameras %s, physics %s",
        *(scenario.name, options.seed, shown, ", ".join(config.robot.cameras), config.physics),
    )
    with ExitStack() as stack:
        stack.enter_context(left_by_signals())
        world = stack.enter_context(SimulatedWorld(config))
        stack.enter_context(traceback_in(options.out / "run.json"))
        claim_folder(options.out, overwrite=options.overwrite)
        folder = stack.enter_context(
            RunFolder(
                options.out,
                scenario.resolved(options.seed, versions()),
                about,
                config.robot.cameras,
                frames=options.frames,
            )
        )
        keep_own_files(scenario.kept_files(), options.out)
        title = f"{scenario.name}, seed {options.seed}, tracker {shown}"
        recorder = None
        if is_recorded(options.record):
            from peopleboy.scenarios.recording.recorder import Recorder  # here, as it loads rerun
            from peopleboy.tracker.reproductions.attention.attentive_explanation import AttentiveExplanation

            recorder = stack.enter_context(
                Recorder(
                    options.out / "recording.rrd",
                    config,
                    title=title,
                    viewer=options.viewer,
                    watched=tracker.cameras,
                    attends=isinstance(explanation_of(tracker), AttentiveExplanation),
                    is_lossless=options.lossless,
                )
            )
        faults, is_secret = scenario.faults, scenario.drive is not None
        observers = RunObservers(config, title, recorder, options.boxes, faults=faults, is_secret=is_secret)
        _LOG.info("%s: the world is built; running %d frames", scenario.name, frames)
        began_s = time.monotonic()
        stage = FaultySensors(world, faults)
        checked = CheckedTracker(tracker, f"tracker {shown!r}", config.robot.cameras)
        eyes = FaultyTracker(checked, faults)
        for tick in closed_loop(stage, eyes, scenario.make_behaviour(), frames):
            events = observers.update(tick)
            folder.write(tick, [event.to_json() for event in events])
            report(tick, frames)
        folder.flush()
        write_latency(options.out, checked.times_ms)
        took_s = time.monotonic() - began_s
        _LOG.info("%s: %.1f s, %.0f frames/s", scenario.name, took_s, frames / max(took_s, 1e-3))
        if episode is None:
            drive = _score_drive(scenario, config, observers.drive.record())
        else:
            drive = episode.scores
            episode.write_rewards(options.out, config.control_hz)
        scores = score_run(options.out, frames, drive, options.boxes, shown)
        scores = replace(scores, contacts=tuple(observers.contacts.contacts))
        observers.save(options.out)
        save_gallery()
        folder.complete(scores.to_json())
        _LOG.info("wrote %s", options.out)
    return scores


def about_run(scenario: Scenario, options: RunOptions, config: WorldConfig, tracker: str) -> dict[str, Any]:
    """Return the entries of run.json of a run with this tracker."""
    about = {
        "scenario": scenario.name,
        "seed": options.seed,
        "tracker": tracker,
        "boxes": options.boxes,
        "renderer": options.renderer,
        "rate_hz": config.control_hz,
        "images": options.frames,
        "planned_frames": scenario.frames,
        "gains": about_gains(config.robot.cameras),
    }
    return about if scenario.own_behaviour is None else about | {"behaviour": scenario.own_behaviour}


def _score_drive(scenario: Scenario, config: WorldConfig, drive: DriveRecord) -> DriveScores:
    """Score the robot's tasks: that of its behaviour, and comfort if it moved among people."""
    following = corridor = comfort = None
    if scenario.robot.behaviour in FOLLOWERS and config.people:
        task = following_task(config, scenario.follow_config().keep_height)
        following = score_following(drive, task)
    if scenario.robot.behaviour == "follow_corridor":
        corridor = score_corridor(drive, legs_of(scenario.plan))
    if drive.has_moved and config.people:
        comfort = score_comfort(drive)
    task_there = goal_task(scenario)
    goal = None if task_there is None else score_goal(drive, task_there)
    return DriveScores(goal, following, corridor, comfort)


def save_episode(
    scenario: Scenario, commands: Sequence[Command], options: RunOptions, result: EpisodeResult
) -> RunScores:
    """Write an episode as a run's folder, by replaying its commands in the same world.

    Args:
        scenario: scenario of the episode, with its settings.
        commands: the robot's commands, one per step.
        options: options of the run.
        result: what happened in the episode.

    Raises:
        BadInput: the folder cannot be written to.
    """
    return _run(scenario.driven([*commands, STOP]), options, lambda _tick, _frames: None, result)


def is_finished(scenario: Scenario, options: RunOptions) -> bool:
    """Return whether the folder holds this run, complete, and with images if the options ask for them.

    False if the run is to be replaced.

    Raises:
        BadInput: the folder holds a complete run of another scenario, seed, tracker, kind of boxes or
            version, or a damaged run.
    """
    if options.overwrite or note_on(options.out):
        return False
    scenario = options.applied_to(scenario)
    run = open_run(options.out, may_be_sampled=True)
    tracker = tracker_name(scenario, options)
    if run.about.tracker != shown_name(tracker):
        raise BadInput(
            f"{options.out}: was run with tracker {run.about.tracker!r}; give --overwrite, or another --out"
        )
    if run.about.boxes != options.boxes:
        raise BadInput(
            f"{options.out}: was run with --boxes {run.about.boxes}; give --overwrite, or another --out"
        )
    if run.about.behaviour != scenario.own_behaviour:
        was = run.about.behaviour or run.scenario.robot.behaviour
        raise BadInput(f"{options.out}: was run with behaviour {was!r}; give --overwrite, or another --out")
    if run.about.choice != (None if options.choice is None else options.choice.to_json()):
        raise BadInput(f"{options.out}: was run with another choice of frames; give another --out")
    if options.frames and not run.about.images:
        return False
    mounted = scenario.mounting(tracker_cameras(tracker))
    resolved = _as_read(mounted.resolved(options.seed, versions()))
    if (run.played, run.about.renderer) != (resolved, options.renderer) or not are_kept(
        scenario.kept_files(), options.out
    ):
        raise BadInput(
            f"{options.out}: is a run of another scenario or version; give --overwrite, or another --out"
        )
    return True


def _as_read(data: object) -> object:
    return yaml.safe_load(yaml.safe_dump(data))
