import numpy as np
import pytest

from peopleboy.sim.people.conducts import pace_among
from peopleboy.sim.people.crowd import those_present
from peopleboy.sim.people.person_config import Waypoint
from tests.helpers.worlds.walkers import NO_WALLS, make_person

WAY = ((0.0, 0.0), (4.0, 0.0), (4.0, 2.0))


@pytest.mark.parametrize(
    ("progress", "company", "pace"),
    [
        (0.5, [], 1.0),
        (0.5, [0.4], 1.0),  # 0.4 m ahead
        (0.5, [0.125, 0.9], 0.0),  # 1.5 m ahead of the last
        (1.0, [0.7625], pytest.approx(0.5)),  # 0.95 m
        (1.5, [0.875], pytest.approx(0.0)),  # 1.5 m, round the corner
        (0.2, [1.9], 1.0),
    ],
)
def test_who_is_ahead_slows_by_how_far(progress, company, pace):
    assert pace_among(WAY, progress, company) == pace


def test_a_group_waits_for_one_who_starts_late_and_is_slow():
    def member(name, y, speed):
        way = (Waypoint(at_m=(0.0, y)), Waypoint(at_m=(10.0, y), speed_m_s=speed))
        return make_person(name=name, path=way, group="us")

    people = [member("ann", 0.0, 1.3), member("bob", 0.8, 0.6)]
    apart = []
    for k in range(120):
        present, progress = those_present(people), [p.progress for p in people]
        for p, company in zip(people, reversed(progress), strict=True):
            p.step(k / 15, 1 / 15, present, None, NO_WALLS, [company])
        apart.append(people[0].position[0] - people[1].position[0])
    assert max(apart) < 1.3
    assert np.hypot(*people[0].velocity) == pytest.approx(0.6, abs=0.05)
