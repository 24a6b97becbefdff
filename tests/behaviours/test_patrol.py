from peopleboy.behaviours.behaviour import Command
from peopleboy.behaviours.patrol import Patrol, PatrolConfig
from tests.helpers.percepts.percepts import percept, person
from tests.helpers.percepts.toy_world import STEP_S

AHEAD = Command(linear_m_s=0.3, angular_rad_s=0.0)
CONFIG = PatrolConfig(follow_s=4.0, lost_s=2.0)


class Round:
    mode, reason, following = "corridor", "walls heard", None

    def command(self, percept):  # noqa: ARG002
        return AHEAD


def patrol(*frames_of_people):
    """Feed one group of people per frame; give modes and commands."""
    robot, modes, commands, turn = Patrol(Round(), config=CONFIG), [], [], 0.0
    for frame, people in enumerate(frames_of_people):
        commands.append(robot.command(percept(frame * STEP_S, *people, angular_rad_s=turn)))
        modes.append(robot.mode)
        turn = commands[-1].angular_rad_s
    return modes, commands


def changes(modes):
    return [mode for mode, before in zip(modes, ["", *modes], strict=False) if mode != before]


def test_a_patrol_keeps_to_its_round_while_nobody_is_near():
    modes, commands = patrol(*[[], [person(height=0.2)]] * 20)
    assert changes(modes) == ["corridor"]
    assert set(commands) == {AHEAD}


def test_somebody_who_turns_up_is_followed_for_a_while_and_then_let_go_for_good():
    modes, commands = patrol(*[[person(x=0.5)]] * 150)
    assert changes(modes) == ["corridor", "follow", "return", "corridor"]
    assert commands[-1] == AHEAD


def test_after_a_lost_person_the_robot_turns_back_to_its_old_heading():
    modes, commands = patrol(*[[person(x=0.5)]] * 20, *[[]] * 120)
    assert changes(modes)[-2:] == ["return", "corridor"]
    heading = sum(command.angular_rad_s for command in commands) * STEP_S
    assert abs(heading) < 2.0 * CONFIG.return_rad
