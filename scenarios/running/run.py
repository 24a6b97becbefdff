"""One run: build the world of a scenario, close the loop, and leave a folder behind."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from peopleboy.bad_input import BadInput
from peopleboy.own_code import traceback_in
from peopleboy.scenarios.files.own_files import keep_own_files
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.faults import FaultySensors, FaultyTracker
from peopleboy.scenarios.loop.loop import Tick, closed_loop
from peopleboy.scenarios.loop.tracker_by_name import check_cameras, make_eyes
from peopleboy.scenarios.recording.recorder import Recorder
from peopleboy.scenarios.run_folder.folder import RunFolder, claim_folder, versions
from peopleboy.scenarios.run_folder.image_files import about_gains
from peopleboy.scenarios.run_folder.output import left_by_sigterm
from peopleboy.scenarios.running.watchers import Watchers
from peopleboy.scenarios.scores.following_score import following_task
from peopleboy.scenarios.scores.run_scores import RunScores, score_run
from peopleboy.sim.world import World
from peopleboy.tracker.checked_tracker import CheckedTracker
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.tracker.trackers import knows_again

FOLLOWERS = ("follow_person", "patrol")


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions:
    """How to run a scenario.

    Attributes:
        seed: 0 or more; everything random follows from it.
        out: the run's folder.
        frames: whether to write every image.
        tracker: name of the tracker, "truth", or "module:Class"; None for the scenario's.
        boxes: what the tracker's boxes are drawn round, and so those of the truth that they are held against.
        renderer: "raycast" or "bullet".
        record: whether to write recording.rrd.
        lossless: whether its images are kept without loss.
        viewer: address of a viewer to show the recording at once; None for none.
        overwrite: whether an earlier run in that folder may be replaced.
    """

    seed: int
    out: Path
    frames: bool = False
    tracker: str | None = None
    boxes: BoxKind = BoxKind.TORSO
    renderer: str = "raycast"
    record: bool = True
    lossless: bool = False
    viewer: str | None = None
    overwrite: bool = False


def tracker_name(scenario: Scenario, options: RunOptions) -> str:
    """Name the tracker of a run: the one asked for, or else the scenario's."""
    return scenario.tracker if options.tracker is None else options.tracker


def run(
    scenario: Scenario,
    options: RunOptions,
    report: Callable[[Tick, int], None] = lambda _tick, _frames: None,
) -> RunScores:
    """Run a scenario from start to end and write its folder.

    Args:
        scenario: what to run.
        options: how.
        report: called after every tick with the number of all ticks, such as by a progress bar.

    Returns:
        The scores, as metrics.json has them.

    Raises:
        BadInput: an option cannot be used, and nothing is written then; or tracker or behaviour gave what
            cannot be used, and the folder says that the run failed.
        OwnCodeFailed: tracker or behaviour raised an error; the folder says so, with the traceback.
    """
    if options.seed < 0:
        raise BadInput(f"--seed {options.seed}: must be 0 or more")
    world: World  # the oracle looks at it only once it is built
    name, given = tracker_name(scenario, options), scenario.robot.cameras
    tracker = make_eyes(name, options.seed, lambda: world.truth())
    scenario = scenario.mounting(tracker.cameras)
    mounted = [camera for camera in scenario.robot.cameras if camera not in given]
    config = scenario.world(options.seed, options.renderer)
    check_cameras(tracker, config.robot.cameras)
    about = {
        "scenario": scenario.name,
        "seed": options.seed,
        "tracker": name,
        "boxes": options.boxes,
        "renderer": options.renderer,
        "rate_hz": config.control_hz,
        "images": options.frames,
        "gains": about_gains(config.robot.cameras),
    } | ({"mounted_for_tracker": mounted} if mounted else {})
    if scenario.own_behaviour is not None:
        about["behaviour"] = scenario.own_behaviour
    with ExitStack() as stack:
        stack.enter_context(left_by_sigterm())
        world = stack.enter_context(World(config))
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
        title = f"{scenario.name}, seed {options.seed}, tracker {name}"
        recorder = None
        if options.record:
            recorder = stack.enter_context(
                Recorder(
                    options.out / "recording.rrd",
                    config,
                    title=title,
                    viewer=options.viewer,
                    watched=tracker.cameras,
                    attends=knows_again(tracker),
                    is_lossless=options.lossless,
                )
            )
        faults, is_secret = scenario.spec.faults, scenario.drive is not None
        watchers = Watchers(config, title, recorder, options.boxes, faults=faults, is_secret=is_secret)
        frames = round(scenario.duration_s * config.control_hz)
        stage = FaultySensors(world, faults, config.robot.sonar.farthest_m)
        checked = CheckedTracker(tracker, f"tracker {name!r}", config.robot.cameras)
        eyes = FaultyTracker(checked, faults)
        for tick in closed_loop(stage, eyes, scenario.make_behaviour(), frames):
            events = watchers.update(tick)
            folder.write(tick, [event.to_json() for event in events])
            report(tick, frames)
        folder.flush()
        following = None
        if scenario.robot.behaviour in FOLLOWERS and config.people:
            task = following_task(config, scenario.follow_config().keep_height)
            following = watchers.following.score(task)
        corridor = None
        if scenario.robot.behaviour == "follow_corridor":
            corridor = watchers.corridor.score(scenario.plan)
        comfort = None
        if scenario.robot.behaviour != "stand" and config.people:
            comfort = watchers.comfort.score()
        scores = score_run(options.out, frames, following, corridor, comfort, options.boxes, name)
        watchers.save(options.out)
        folder.complete(scores.to_json())
    return scores
