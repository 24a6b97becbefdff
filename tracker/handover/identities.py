"""Whose track is whose: one number for each person, whatever camera sees it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field

from peopleboy.tracker.track import Track

Key = tuple[str, int]
"""A camera, and the id of a track in it."""

YOUNG_S = 1.0
"""A number that is younger than this gives way to the one that the person had before."""


@dataclass(slots=True)
class Identities:
    """The numbers of the tracks of two cameras.

    Attributes:
        number: of each track.
    """

    number: dict[Key, int] = field(default_factory=dict)
    _newest: int = 0

    def of(self, camera: str, tracks: Collection[Track]) -> dict[int, Track]:
        """List the tracks of a camera that have a number by it."""
        keys = {(camera, track.id): track for track in tracks}
        return {self.number[key]: track for key, track in keys.items() if key in self.number}

    def name(
        self,
        camera: str,
        tracks: Collection[Track],
        known: Mapping[int, Key],
        guess: Callable[[Track, Collection[int]], int | None],
    ) -> None:
        """Number the tracks of a camera that have none yet.

        Args:
            camera: its name.
            tracks: all of them.
            known: for ids of tracks that agree with one of the other camera, that one.
            guess: tells the number of a track that agrees with none that has one, and none of these that
                its camera has; None for a new one.
        """
        for track in tracks:
            if (camera, track.id) not in self.number:
                present = self.of(camera, tracks).keys()
                number = self.number.get(known[track.id]) if track.id in known else None
                if number is None:
                    number = guess(track, present)
                if number is None or number in present:
                    number = self._new()
                self._take((camera, track.id), number)

    def agree(self, follower: tuple[Key, Track], leader: tuple[Key, Track], present: Collection[Key]) -> None:
        """Give two tracks that are one person the same number.

        A number that is young gives way; otherwise the leader's stays. Whoever else has the number in the
        camera of the one that gives way gets a new one.
        """
        (yields, one), (stays, other) = follower, leader
        if self.number[yields] == self.number[stays]:
            return
        if other.age_s < YOUNG_S <= one.age_s:
            yields, stays = stays, yields
        for key in self._take(yields, self.number[stays]):
            if key in present:
                self.number[key] = self._new()

    def _new(self) -> int:
        self._newest += 1
        return self._newest

    def _take(self, taker: Key, number: int) -> list[Key]:
        """Give a number to one track of a camera alone; who had it there is told, and has none any more."""
        had = [key for key, one in self.number.items() if one == number and key[0] == taker[0]]
        for key in had:
            del self.number[key]
        self.number[taker] = number
        return had
