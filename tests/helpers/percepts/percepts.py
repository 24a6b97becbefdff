"""What a behaviour is told: free space, single echoes, people in the image."""

import dataclasses

import numpy as np

from peopleboy.behaviours.percept import Percept, SeenPerson
from tests.helpers.percepts.toy_world import SONAR_ANGLE


def percept_of(ranges_m, **changes):
    percept = Percept(
        time_s=1.0,
        people=(),
        sonar_m=np.array(ranges_m, float),
        sonar_angle_rad=SONAR_ANGLE,
        linear_m_s=0.0,
        angular_rad_s=0.0,
    )
    return dataclasses.replace(percept, **changes)


def free(**ranges_m):
    """All sonars free but some: i3=0.4 sets sonar 3."""
    reading = np.full(16, 5.0)
    for name, value in ranges_m.items():
        reading[int(name[1:])] = value
    return percept_of(reading)


def person(x=0.0, height=0.4, **changes):
    seen = SeenPerson(id=1, x=x, height=height, top=0.1, bottom=0.5, confidence=0.9, is_visible=True)
    return dataclasses.replace(seen, **changes)


def percept(time_s, *people, **changes):
    return dataclasses.replace(free(), time_s=time_s, people=people, **changes)
