"""Cardboard people shown to the panoramic tracker, with checks of what must hold at every image."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from peopleboy.tracker.frame import Odometry
from peopleboy.tracker.sensors.panorama.panorama_sensor import PanoramaSensor
from peopleboy.tracker.track import Track
from peopleboy.tracker.tracking.config import PANORAMIC, PeopleTrackerConfig
from peopleboy.tracker.tracking.people_tracker import PeopleTracker
from tests.helpers.images.cardboard import Cardboard, CardboardEyes, CardboardModel, frame_of

Tracks = tuple[Track, ...]


def cardboard_tracker(config: PeopleTrackerConfig = PANORAMIC) -> PeopleTracker:
    """A tracker with stand-ins for all that is taught."""
    sensor = PanoramaSensor(tracker=config, model=CardboardModel())
    sensor._foreground = CardboardEyes()
    return PeopleTracker((sensor,), config)


class Stage:
    """Shows a tracker people at a rate."""

    def __init__(self, rate_hz: int = 15, config: PeopleTrackerConfig = PANORAMIC) -> None:
        self.tracker = cardboard_tracker(config)
        self.rate_hz, self.frames = rate_hz, 0
        self.ever: set[int] = set()

    @property
    def time_s(self) -> float:
        """When the next image is taken."""
        return self.frames / self.rate_hz

    def show(self, *people: Cardboard, odometry: Odometry | None = None) -> Tracks:
        """Show whoever is there, and check that nobody is told twice."""
        tracks = self.tracker.update(frame_of(self.time_s, people, odometry))
        self.frames += 1
        numbers = [track.id for track in tracks]
        assert len(set(numbers)) == len(numbers)
        assert all(number >= 1 for number in numbers)
        places = [np.array(track.place.position_m) for track in tracks if track.place is not None]
        for k, place in enumerate(places):
            assert all(np.linalg.norm(place - other) >= 0.2 for other in places[:k])
        self.ever |= set(numbers)
        return tracks

    def play(self, seconds: float, people_at: Callable[[float], Sequence[Cardboard]]) -> list[Tracks]:
        """Show for so long whoever is there at a time since now; all the tracks."""
        begin = self.frames
        return [
            self.show(*people_at((self.frames - begin) / self.rate_hz))
            for _ in range(round(seconds * self.rate_hz))
        ]


def number_at(tracks: Sequence[Track], person: Cardboard, within_m: float = 0.5) -> int | None:
    """The number of the track nearest to somebody; None if none is near."""
    place = person.distance_m * np.array([math.cos(person.bearing_rad), math.sin(person.bearing_rad)])
    away = {
        float(np.linalg.norm(track.place.position_m - place)): track.id
        for track in tracks
        if track.place is not None
    }
    return away[min(away)] if away and min(away) < within_m else None
