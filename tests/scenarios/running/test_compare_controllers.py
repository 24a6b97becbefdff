from peopleboy.scenarios.running.compare_controllers import Controller, compare, parse_controller
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.tracker.footage.box_kinds import BoxKind
from tests.helpers.calls.refused import refused


def test_a_controller_is_a_behaviour_and_the_eyes_it_sees_by():
    assert parse_controller("follow_person@truth") == Controller("follow_person", "truth")
    assert str(parse_controller("patrol@detection")) == "patrol"
    with refused("'dance'", "follow_person"):
        parse_controller("dance")
    with refused("'sonar'", "contour"):
        parse_controller("stand@sonar")


def test_a_controller_named_twice_is_refused(tmp_path):
    with refused("--controllers stand,stand"):
        compare(
            "single_follow",
            [parse_controller("stand")] * 2,
            range(1),
            RunOptions(seed=0, out=tmp_path),
            Workers(),
        )


def test_whole_people_are_boxed_by_trackers_of_ones_own_alone(tmp_path):
    chosen = [parse_controller("stand@truth")]
    with refused("--boxes whole", "leave it out"):
        options = RunOptions(seed=0, out=tmp_path, boxes=BoxKind.WHOLE)
        compare("single_follow", chosen, range(1), options, Workers())
