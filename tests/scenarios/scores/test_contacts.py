import pytest

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.scores.contacts import ContactLog
from peopleboy.sim.truth.scenes import Bystander, ImageFreeTruth


def instant(time_s, robot_m_s=0.0, person_m_s=0.0, *, touches=(), turn=0.0):
    """A person ahead of the robot, both moving along x."""
    person = Bystander(
        **dict.fromkeys(Bystander._fields, 0.0)
        | {"name": "anna", "position_m": (0.4, 0.0), "velocity_m_s": (person_m_s, 0.0)}
    )
    return ImageFreeTruth(
        time_s=time_s, robot=Pose2(), robot_velocity=(robot_m_s, turn), contacts=touches, people=(person,)
    )


def contacts(*instants):
    log = ContactLog()
    for one in instants:
        log.add(one)
    return log.contacts


@pytest.mark.parametrize(
    ("robot_m_s", "person_m_s", "relative_m_s", "cause"),
    [
        (0.3, 0.0, 0.3, "robot"),
        (0.3, 0.2, 0.1, "robot"),
        (0.3, -1.0, 1.3, "person"),
        (0.0, -1.0, 1.0, "person"),
        (-0.2, -1.0, 0.8, "person"),
    ],
)
def test_the_faster_one_causes_a_contact(robot_m_s, person_m_s, relative_m_s, cause):
    (one,) = contacts(instant(0.0, robot_m_s, person_m_s), instant(0.1, touches=("anna",)))
    assert (one.other, one.cause) == ("anna", cause)
    assert one.robot_m_s == pytest.approx(robot_m_s)
    assert one.relative_m_s == pytest.approx(relative_m_s)


def test_a_thing_that_touches_a_robot_at_rest_is_moved_by_a_person_and_a_turn_counts():
    (rest,) = contacts(instant(0.0), instant(0.1, touches=("chair",)))
    (turning,) = contacts(instant(0.0, turn=1.0), instant(0.1, touches=("chair",)))
    assert (rest.cause, turning.cause) == ("person", "robot")
    assert turning.robot_m_s == pytest.approx(0.355)


def test_bouncing_is_one_contact():
    touch = instant(0.0, 0.1, touches=("box",))
    assert len(contacts(*[replace_time(touch, t) for t in (0.0, 0.1, 0.3, 0.5)])) == 1
    assert len(contacts(*[replace_time(touch, t) for t in (0.0, 0.5)])) == 2


def replace_time(truth, time_s):
    return truth._replace(time_s=time_s)
