"""Patrol: follow the corridor, follow a detected person for a while, then continue along the corridor."""

import math
from dataclasses import dataclass, replace

from peopleboy.behaviours.behaviour import Behaviour, Command
from peopleboy.behaviours.following.follow_person import FollowConfig, FollowPerson
from peopleboy.behaviours.percept import Percept, SeenPerson


@dataclass(frozen=True, slots=True, kw_only=True)
class PatrolConfig:
    """Conditions for interrupting the patrol for a person, and for returning.

    Attributes:
        notice_height: [image heights] people at least as tall are noticed: 0.25 is 8.7 m for 1.75 m ...
        notice_s: [s] ... when they have been visible for this long.
        follow_s: [s] longest time for which a person is followed.
        lost_s: [s] time without observation after which the robot gives up on a person.
        min_confidence: people of lower confidence are ignored.
        return_rad: [rad] greatest remaining angle to the old heading at the end of the return.
        return_gain: [1/s] turn rate per angle on the way back.
        return_rad_s: [rad/s] highest turn rate for that.
        return_s: [s] longest time for the return; then corridor following takes over.
    """

    notice_height: float = 0.25
    notice_s: float = 0.6
    follow_s: float = 20.0
    lost_s: float = 8.0
    min_confidence: float = 0.5
    return_rad: float = math.radians(6.0)
    return_gain: float = 1.5
    return_rad_s: float = 0.8
    return_s: float = 8.0


class Patrol:
    """Combination of a patrolling behaviour, such as corridor following, with person following."""

    def __init__(
        self, round_: Behaviour, follow: FollowConfig | None = None, config: PatrolConfig | None = None
    ) -> None:
        self._round = round_
        self._follow_config = follow
        self._config = PatrolConfig() if config is None else config
        self._follower: FollowPerson | None = None
        self._known: frozenset[int] = frozenset()
        self._noticed_s = 0.0
        self._followed_s = 0.0
        self._lost_s = 0.0
        self._away_rad = 0.0
        self._returning_s: float | None = None
        self._time_s: float | None = None
        self._why = ""

    @property
    def mode(self) -> str:
        """Mode of the active behaviour, or "return"."""
        if self._follower is not None:
            return self._follower.mode
        return self._round.mode if self._returning_s is None else "return"

    @property
    def reason(self) -> str:
        """Why the robot interrupts or resumes the patrol, or the active behaviour's reason."""
        if self._follower is not None:
            return self._follower.reason
        return self._round.reason if self._returning_s is None else self._why

    @property
    def following(self) -> int | None:
        """Id of the followed track; None on patrol."""
        return None if self._follower is None else self._follower.following

    def command(self, percept: Percept) -> Command:
        """Return the command of the active behaviour."""
        step_s = 0.0 if self._time_s is None else max(percept.time_s - self._time_s, 0.0)
        self._time_s = percept.time_s
        self._away_rad = math.remainder(self._away_rad + percept.angular_rad_s * step_s, math.tau)
        if self._follower is not None:
            return self._go_after(self._follower, percept, step_s)
        self._noticed_s = self._noticed_s + step_s if self._notices(percept) else 0.0
        if self._noticed_s >= self._config.notice_s:
            if self._returning_s is None:
                self._away_rad = 0.0
            self._follower, self._returning_s = FollowPerson(self._follow_config), None
            self._followed_s = self._lost_s = 0.0
            return self._go_after(self._follower, percept, step_s)
        if self._returning_s is not None:
            return self._return(self._returning_s, percept, step_s)
        return self._round.command(percept)

    def _notices(self, percept: Percept) -> bool:
        """Return whether there is a person that the robot has not followed yet."""
        return any(self._is_new(person) for person in percept.people)

    def _is_new(self, person: SeenPerson) -> bool:
        return (
            person.is_sound
            and person.is_visible
            and person.id not in self._known
            and person.confidence >= self._config.min_confidence
            and person.height >= self._config.notice_height
        )

    def _go_after(self, follower: FollowPerson, percept: Percept, step_s: float) -> Command:
        """Follow until the time is over or the person is lost; then start the return."""
        people = tuple(person for person in percept.people if person.id not in self._known)
        command = follower.command(replace(percept, people=people))
        target = follower.state.target
        self._followed_s += step_s
        self._lost_s = 0.0 if follower.mode == "follow" else self._lost_s + step_s
        is_long = self._followed_s > self._config.follow_s
        if not (is_long or self._lost_s > self._config.lost_s):
            return command
        self._why = "followed for long enough" if is_long else "the person is lost"
        if target is not None:
            self._known |= {target.id}
        self._follower, self._returning_s = None, 0.0
        return self._return(0.0, percept, step_s)

    def _return(self, returning_s: float, percept: Percept, step_s: float) -> Command:
        """Turn back to the heading before the interruption, and resume the patrol."""
        self._returning_s = returning_s + step_s
        if abs(self._away_rad) < self._config.return_rad or self._returning_s > self._config.return_s:
            self._returning_s = None
            return self._round.command(percept)
        limit = self._config.return_rad_s
        turn = min(max(-self._config.return_gain * self._away_rad, -limit), limit)
        return Command(linear_m_s=0.0, angular_rad_s=turn)
