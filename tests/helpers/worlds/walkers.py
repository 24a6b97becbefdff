"""People for tests, and their stepping."""

import numpy as np

from peopleboy.sim.people.crowd import those_present
from peopleboy.sim.people.person import Person
from peopleboy.sim.people.person_config import PersonConfig, Waypoint
from peopleboy.sim.people.walking.walker import NO_WALKERS

NO_WALLS = np.empty((0, 4))


def make_person(seed=0, **settings):
    settings.setdefault("name", "ann")
    settings.setdefault("path", (Waypoint(at_m=(0.0, 0.0)),))
    return Person(PersonConfig(**settings), np.random.default_rng(seed))


def walk(person, seconds, dt=1 / 60, start=0.0, robot=None, walls=NO_WALLS):
    """Step one person alone; yields the time after each step."""
    for k in range(round(seconds / dt)):
        person.step(start + k * dt, dt, NO_WALKERS, robot, walls)
        yield start + (k + 1) * dt


def settle(person, seconds, **options):
    for _ in walk(person, seconds, **options):
        pass
    return person


def walk_together(people, seconds, dt=1 / 15, robot=None, walls=NO_WALLS):
    """(T, N, 2) [m] positions of people who see each other."""
    track = []
    for k in range(round(seconds / dt)):
        present = those_present(people)
        for p in people:
            p.step(k * dt, dt, present, robot, walls)
        track.append([p.position.copy() for p in people])
    return np.array(track)
