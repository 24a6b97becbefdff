"""Each word for how people take to the robot: the distance that they keep, and where they look."""

import math

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.sim.people.person import Person
from peopleboy.sim.people.person_config import USUAL, Lead, Reaction, Way, Waypoint
from tests.helpers.worlds.encounters import RATE_HZ, Meeting, drive, meet
from tests.helpers.worlds.walkers import make_person

COMES = drive((0.0, 0.0), (0.5, 0.0))
LOOKS = math.radians(20.0)  # nose within so much of the robot: the gait turns the head by a few degrees


def reaction(way: Way, **values: float) -> Reaction:
    return Reaction(way=way, **(dict(USUAL[way]) | values))


def walker(way: Way, **values: float) -> Person:
    """Somebody who walks towards the robot, a little to the left of its way."""
    path = (Waypoint(at_m=(8.0, 0.1)), Waypoint(at_m=(-4.0, 0.1)))
    return make_person(path=path, reacts=reaction(way, **values))


def stander(way: Way, **values: float) -> Person:
    """Somebody who stands in the robot's way, facing to the left."""
    path = (Waypoint(at_m=(5.0, 0.2), face=(5.0, 3.0)),)
    return make_person(path=path, reacts=reaction(way, **values))


def near(meeting: Meeting, metres: float) -> np.ndarray:
    return meeting.gap < metres


def test_who_ignores_keeps_to_the_way_and_does_not_look():
    standing = meet(stander("ignores"), COMES, 6.0)
    assert np.all(standing.at == standing.at[0])
    assert np.degrees(np.abs(standing.ahead)).max() < 5.0
    polite = make_person(path=(Waypoint(at_m=(8.0, 0.1)), Waypoint(at_m=(-4.0, 0.1))), yields=True)
    walking = walker("ignores")
    there = drive((3.0, 0.0), (0.0, 0.0))
    assert np.abs(meet(walking, there, 6.0).at[:, 1] - 0.1).max() < 1e-9
    assert np.abs(meet(polite, there, 6.0).at[:, 1] - 0.1).max() > 0.3


def test_who_ignores_and_yields_to_people_only_stops_before_the_robot():
    path = (Waypoint(at_m=(8.0, 0.1)), Waypoint(at_m=(-4.0, 0.1)))
    person = make_person(path=path, yields=True, reacts=reaction("ignores"))
    met = meet(person, drive((3.0, 0.0), (0.0, 0.0)), 7.0)
    assert np.abs(met.at[:, 1] - 0.1).max() < 1e-6
    assert 0.4 < met.gap.min() < 1.1
    assert met.speed[-1] < 0.05


@pytest.mark.parametrize("keep_m", [1.2, 1.8])
def test_who_makes_way_walks_round_the_robot_at_the_distance_and_looks_at_it(keep_m):
    met = meet(walker("makes_way", keep_m=keep_m), COMES, 11.0)
    assert met.gap.min() > keep_m - 0.1
    assert met.at[-1, 0] < met.robot[-1, 0] - 2.0
    ahead = near(met, 3.0) & (met.at[:, 0] > met.robot[:, 0])
    assert np.median(met.off[ahead]) < LOOKS


def test_who_stands_in_the_way_steps_aside_for_the_robot_and_back():
    met = meet(stander("makes_way"), COMES, 16.0)
    assert met.gap.min() > 1.2
    assert math.dist(met.at[-1], (5.0, 0.2)) < 0.15
    assert met.off[near(met, 3.0)].max() < LOOKS
    still = meet(stander("makes_way"), drive((1.5, 0.0), (0.0, 0.0)), 3.0)
    assert np.all(still.at == still.at[0])  # nobody makes way for a robot that stands


def test_who_is_curious_walks_up_looks_for_the_time_and_goes_on():
    met = meet(walker("curious", keep_m=1.5, lasts_s=3.0), drive((2.0, 0.0), (0.0, 0.0)), 14.0)
    looks = near(met, 1.9) & (met.speed < 0.05)
    assert looks.sum() / RATE_HZ == pytest.approx(3.0, abs=0.4)
    assert np.all(met.gap[looks] > 1.2)
    assert met.off[looks].max() < LOOKS
    assert met.at[-1, 0] < 0.0
    assert met.off[-1] > math.radians(120.0)


def test_who_is_wary_keeps_clear_and_looks_back():
    standing = meet(stander("wary"), COMES, 10.0)
    assert standing.gap.min() > 2.4
    walks_away = (standing.speed > 0.7) & (standing.at[:, 0] > 5.3)
    assert walks_away.sum() > RATE_HZ
    assert np.abs(np.degrees(standing.ahead[walks_away])).mean() > 60.0  # over the shoulder
    walking = meet(walker("wary"), COMES, 14.0)
    assert walking.gap.min() > 2.3
    assert walking.at[-1, 0] < walking.robot[-1, 0]


def test_who_blocks_stands_before_the_robot_for_the_time_and_goes_on():
    path = (Waypoint(at_m=(4.0, 2.0), pause_s=1.0), Waypoint(at_m=(-4.0, 2.0)))
    person = make_person(path=path, reacts=reaction("blocks", lasts_s=3.0))
    met = meet(person, drive((0.0, 0.0), (0.5, 0.0), stop_s=1.5), 14.0)
    before = (np.abs(met.at[:, 1]) < 0.4) & (met.at[:, 0] > met.robot[:, 0])
    stands = before & (met.speed < 0.05)
    assert stands.sum() / RATE_HZ == pytest.approx(3.0, abs=0.5)
    assert np.all(np.abs(met.gap[stands] - 1.0) < 0.35)
    assert met.off[stands].max() < LOOKS
    assert met.at[-1, 0] < -1.0


def test_who_is_surprised_stops_looks_for_the_time_and_goes_on():
    path = (Waypoint(at_m=(4.0, 4.0)), Waypoint(at_m=(4.0, -4.0)))
    met = meet(make_person(path=path, reacts=reaction("surprised")), drive((2.0, 0.0), (0.0, 0.0)), 10.0)
    stands = (met.speed < 0.05) & (np.arange(len(met.speed)) > RATE_HZ) & (met.at[:, 1] > -3.5)
    assert stands.sum() / RATE_HZ == pytest.approx(2.5, abs=0.4)
    assert np.all(met.gap[stands] < 3.0)
    assert np.median(met.off[stands]) < LOOKS
    assert met.at[-1, 1] < -3.5
    assert np.abs(np.degrees(met.ahead[-1])) < 8.0


@pytest.mark.parametrize("way", ["curious", "blocks", "surprised"])
def test_who_goes_on_walks_round_a_robot_that_stands_in_its_way(way):
    path = (Waypoint(at_m=(4.0, 0.0)), Waypoint(at_m=(-4.0, 0.1)))
    met = meet(make_person(path=path, reacts=reaction(way, lasts_s=2.0)), drive((0.0, 0.0), (0.0, 0.0)), 16.0)
    assert met.at[-1, 0] < -3.5
    assert met.gap.min() > 0.6


@pytest.mark.parametrize("way", ["makes_way", "curious", "wary", "blocks", "surprised"])
def test_nobody_reacts_to_a_robot_behind_a_wall(way):
    wall = np.array([[2.5, -3.0, 2.6, 3.0]])
    met = meet(stander(way), drive((2.0, 0.0), (0.0, 0.0)), 2.0, walls=wall)
    assert np.all(met.at == met.at[0])
    assert np.degrees(np.abs(met.ahead)).max() < 5.0


def test_an_encounter_is_told_from_the_next_one():
    there_and_back = [(6.0, 0.0), (0.0, 0.0)]

    def way(time_s):
        return np.array(there_and_back[int(2.0 < time_s < 6.0)]) * [-1.0, 1.0] + [4.0, 0.0]

    met = meet(stander("surprised", from_m=4.0, lasts_s=1.0), way, 9.0)
    looks = np.abs(np.degrees(met.ahead)) > 30.0
    assert np.sum(np.diff(looks.astype(int)) == 1) == 1


def test_who_leads_waits_calls_and_goes_on_when_the_robot_is_near_again():
    path = (Waypoint(at_m=(3.0, 0.0)), Waypoint(at_m=(12.0, 0.0)))
    met = meet(make_person(path=path, leads=Lead()), COMES, 18.0)
    assert met.gap.max() < 4.9
    calls = np.array(met.posture) == "calling"
    assert calls.any()
    waits = calls & (met.speed < 0.05)
    assert np.median(met.off[waits]) < LOOKS
    assert met.at[-1, 0] > 11.5
    looks_back = ~calls & (met.speed > 0.5) & (np.abs(np.degrees(met.ahead)) > 60.0)
    assert looks_back.any()
    lost = meet(make_person(path=path, leads=Lead(at_most_s=2.0)), drive((-2.0, 0.0), (0.0, 0.0)), 14.0)
    assert lost.at[-1, 0] > 11.5


def test_who_calls_raises_an_arm_until_the_robot_is_near_and_goes_on():
    first = Waypoint(at_m=(5.0, 0.0), posture="calling", until_robot_within_m=2.0)
    person = make_person(path=(first, Waypoint(at_m=(5.0, 4.0))))
    calls = meet(person, COMES, 5.5)
    assert set(calls.posture) == {"calling"}
    assert calls.off[RATE_HZ:].max() < LOOKS
    wrist, shoulder = person.joints()[9], person.joints()[5]
    assert wrist[2] > shoulder[2] + 0.3
    assert person.joints()[10][2] < person.joints()[6][2] - 0.3  # the other arm hangs
    assert meet(person, drive((3.5, 0.0), (0.0, 0.0)), 5.0).at[-1, 1] > 3.0
    alone = make_person(
        path=(Waypoint(at_m=(5.0, 0.0), until_robot_within_m=2.0, waits_at_most_s=1.0), path_end())
    )
    assert meet(alone, drive((0.0, 0.0), (0.0, 0.0)), 6.0).at[-1, 1] > 2.0


def path_end() -> Waypoint:
    return Waypoint(at_m=(5.0, 4.0))


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"way": "shy"}, "'shy' must be one of ignores, makes_way"),
        ({"way": "ignores", "from_m": 2.0}, "from_m 2: not used by a person who ignores the robot"),
        ({"way": "wary", "from_m": 2.0, "keep_m": 3.0}, "keep_m 3 must be at most from_m, 2"),
        ({"way": "surprised", "from_m": 2.0, "lasts_s": 0.0}, "lasts_s: must be at least 0.2, got 0.0"),
    ],
)
def test_a_reaction_that_cannot_be_is_refused(values, said):
    with pytest.raises(BadInput, match=said):
        Reaction(**values)


def test_a_leader_that_would_never_go_on_is_refused():
    with pytest.raises(BadInput, match=r"goes_on_within_m 3 must be"):
        Lead(waits_beyond_m=3.0, goes_on_within_m=3.0)
