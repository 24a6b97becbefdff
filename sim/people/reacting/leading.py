"""Leading the robot: walking ahead, looking back, and waiting for it where it falls behind."""

from __future__ import annotations

from typing import Final

from peopleboy.sim.people.reacting.encounter import Situation
from peopleboy.sim.people.reacting.reaction import Lead
from peopleboy.sim.people.walking.wish import Wish

_GLANCE_EVERY_S: Final = 4.0
_GLANCE_S: Final = 1.2


class Leading:
    """A person who leads the robot along its path."""

    def __init__(self, lead: Lead) -> None:
        self._lead = lead
        self._waited_s: float | None = None
        self._has_given_up = False
        self._walked_s = 0.0

    def wish(self, dt_s: float, now: Situation) -> Wish:
        """Tell what the person would rather do than its script, once a control step of dt_s [s]."""
        robot, gap_m, lead = now.robot.position, now.gap_m, self._lead
        if gap_m <= lead.goes_on_within_m:
            self._waited_s, self._has_given_up = None, False
        elif self._waited_s is None and gap_m > lead.waits_beyond_m and not self._has_given_up:
            self._waited_s = 0.0
        if self._waited_s is not None:
            self._waited_s += dt_s
            if self._waited_s <= lead.at_most_s:
                return Wish(stands=True, faces=robot, looks_at=robot, calls=True)
            self._waited_s, self._has_given_up = None, True
        self._walked_s += dt_s
        is_glancing = self._walked_s % _GLANCE_EVERY_S > _GLANCE_EVERY_S - _GLANCE_S
        return Wish(looks_at=robot if is_glancing else None)
