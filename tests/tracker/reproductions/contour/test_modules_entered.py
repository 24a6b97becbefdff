import sys
from dataclasses import replace

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.world import SimulatedWorld
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame
from peopleboy.tracker.trackers import CONTOUR_TRACKER, make_tracker

MOST = 12


def frames_of_four(count):
    """Render the first frames of four people who cross, the robot standing still."""
    before = None
    with SimulatedWorld(load_scenario("crossing_4").world(0)) as world:
        for _ in range(count):
            observation = world.observe()
            frame = Frame.from_observation(observation, before)
            yield replace(frame, images={name: frame.images[name] for name in (THERMAL, COLOUR)})
            before = observation.odometry
            world.step(0.0, 0.0)


def modules_entered(work):
    """Name the tracker's modules that are entered; compiled kernels are no frames of Python's."""
    names = set()

    def note(frame, event, _):
        if event == "call":
            names.add(frame.f_globals.get("__name__", ""))

    sys.setprofile(note)
    try:
        work()
    finally:
        sys.setprofile(None)
    return {name for name in names if name.startswith("peopleboy.tracker.")}


def test_one_tick_of_the_tracker_can_be_read_in_a_dozen_modules():
    tracker = make_tracker(CONTOUR_TRACKER)
    *first, last = frames_of_four(61)
    for frame in first:
        tracker.update(frame)
    assert len(tracker.explanation.particles.keys() - {0}) == 4
    entered = modules_entered(lambda: tracker.update(last))
    assert len(entered) <= MOST, "\n".join(sorted(entered))
