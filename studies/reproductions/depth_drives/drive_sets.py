"""The twelve data sets of the thesis on situation awareness, and the scenarios that stand for them."""

from __future__ import annotations

from typing import Final

SETS: Final = (
    "leader_far_ahead",
    "follow_at_distance",
    "corridor_meeting_lights",
    "hall_visits_moving",
    "leader_swap",
    "corridor_pair_passes",
    "crossing_2_moving",
    "hidden_2s_moving",
    "visitors_in_turn",
    "corridor_past_walls",
    "fast_turn_near",
    "group_abreast_moving",
)
"""Scenarios by the set's number, from 1.

Followers are scripted, so that what a tracker does cannot change the film. Light changes in steps; the spots
of ceiling lamps that gave the thesis its false alarms do not exist here.
"""

TURNS: Final = "fast_turn"
"""Where the robot turns most, for what odometry is worth."""


def set_name(number: int) -> str:
    """Name a set as tables do."""
    return f"set {number}"
