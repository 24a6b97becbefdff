"""Run a scenario, and write images and ground truth of chosen frames only, for a data set of single images.

If nothing depends on the frames in between, they are simulated without images: cameras take images of the
chosen frames only, and noise and gain continue from one of these images to the next.
"""

from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace

from peopleboy.behaviours.behaviour import Command
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.faults import FaultySensors, FaultyTracker
from peopleboy.scenarios.loop.loop import BlindTick, Tick, closed_loop
from peopleboy.scenarios.loop.tracker_by_name import check_cameras, make_named_tracker
from peopleboy.scenarios.run_folder.atomic_output import left_by_signals
from peopleboy.scenarios.run_folder.folder import RunFolder, claim_folder, versions
from peopleboy.scenarios.run_folder.frame_choice import FrameChoice, FramePicker, visible_people
from peopleboy.scenarios.running.blind_drive import blind_percept
from peopleboy.scenarios.running.engine.task import ReportProgress
from peopleboy.scenarios.running.run import about_run, tracker_name
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.sim.observation import Observation, Senses
from peopleboy.sim.truth.scenes import ImageFreeTruth
from peopleboy.sim.world import SimulatedWorld
from peopleboy.tracker.checked_tracker import CheckedTracker
from peopleboy.tracker.tracker_names import shown_name


def sample_run(scenario: Scenario, options: RunOptions, report: ReportProgress) -> None:
    """Run a scenario until its last chosen frame, and write the folder of the run.

    Args:
        scenario: the scenario.
        options: options of the run, with a choice of frames.
        report: called with the number of each frame.

    Raises:
        BadInput: an option is invalid, and nothing is written.
        OwnCodeFailed: the tracker of a robot that follows people raised an error.
    """
    choice = options.choice or FrameChoice()
    scenario = options.applied_to(scenario)
    world: SimulatedWorld  # the oracle accesses it only after it is built
    name = tracker_name(scenario, options)
    tracker = make_named_tracker(name, options.seed, lambda: world.truth())
    scenario = scenario.mounting(tracker.cameras)
    config = scenario.world(options.seed, options.renderer)
    check_cameras(tracker, config.robot.cameras)
    about = about_run(scenario, options, config, shown_name(name)) | {"choice": choice.to_json()}
    picker = FramePicker(choice, range(1, scenario.frames + 1), options.seed)
    kept: list[int] = []
    with ExitStack() as stack:
        stack.enter_context(left_by_signals())
        world = stack.enter_context(SimulatedWorld(config))
        claim_folder(options.out, overwrite=options.overwrite)
        played = scenario.resolved(options.seed, versions())
        folder = stack.enter_context(
            RunFolder(options.out, played, about, config.robot.cameras, frames=options.frames)
        )
        eyes = CheckedTracker(tracker, f"tracker {shown_name(name)!r}", config.robot.cameras)
        ticks = (
            _every_tick(world, scenario, eyes, picker)
            if scenario.needs_every_frame
            else _wanted_ticks(world, scenario, picker)
        )
        for tick, is_chosen in ticks:
            if is_chosen and isinstance(tick, Tick):
                folder.write(tick, ())
                kept.append(tick.frame)
            else:
                folder.skip(tick)
            report(tick.frame)
            if picker.is_done:
                break
        folder.flush()
        folder.complete_sample(kept)


def _every_tick(
    world: SimulatedWorld, scenario: Scenario, tracker: CheckedTracker, picker: FramePicker
) -> Iterator[tuple[Tick, bool]]:
    """Yield each tick of a robot that needs its images, and whether the frame is chosen."""
    faults = scenario.faults
    stage, eyes = FaultySensors(world, faults), FaultyTracker(tracker, faults)
    for tick in closed_loop(stage, eyes, scenario.make_behaviour(), scenario.frames):
        is_chosen = picker.takes(tick.frame, visible_people(tick.truth.people))
        yield replace(tick, tracks=(), explanation=None), is_chosen


def _wanted_ticks(
    world: SimulatedWorld, scenario: Scenario, picker: FramePicker
) -> Iterator[tuple[Tick | BlindTick, bool]]:
    """Yield the chosen ticks, and those in between without images."""
    behaviour = scenario.make_behaviour()
    for frame in range(1, scenario.frames + 1):
        is_chosen = picker.wants(frame) and picker.takes(frame, visible_people(world.truth().people))
        senses = world.observe() if is_chosen else world.sense()
        command = behaviour.command(blind_percept(senses))
        yield _tick(world, frame, senses, behaviour.mode, command), is_chosen
        if frame < scenario.frames:
            world.step(command.linear_m_s, command.angular_rad_s, is_emergency=command.is_emergency)


def _tick(world: SimulatedWorld, frame: int, senses: Senses, mode: str, command: Command) -> Tick | BlindTick:
    if isinstance(senses, Observation):
        return Tick(
            frame=frame,
            observation=senses,
            truths=world.truths(),
            tracks=(),
            explanation=None,
            mode=mode,
            command=command,
        )
    pose, velocity = world.robot.pose(), world.robot.velocity()
    truth = ImageFreeTruth(world.time_s, pose, velocity, world.touching, ())
    return BlindTick(frame=frame, observation=senses, truth=truth, mode=mode, command=command)
