"""The scripted follower with a learned correction of its commands.

Sixteen weights correct the command of `FollowPerson` by at most `MOST`. With zero weights the commands are
those of the scripted follower, so training starts at its performance. The correction is symmetric: that of
the speed depends on mirror-invariant features, that of the turn rate on features that change their sign.

    peopleboy run single_follow --behaviour examples.learning.follower:LearnedFollower
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.behaviours.behaviour import Command
from peopleboy.behaviours.following.follow_person import (
    FollowConfig,
    FollowPerson,
    FollowState,
    distance_error,
)
from peopleboy.behaviours.percept import Percept
from peopleboy.tracker.networks.weights_archive import open_archive

Weights = NDArray[np.float64]  # (16,)

SPEED_SIGHTS: Final = (
    "follow", "too far", "walking", "speed", "off the nose", "drifting", "free ahead", "wait", "recover",
)  # fmt: skip
TURN_SIGHTS: Final = (
    "bearing",
    "drift",
    "turning",
    "freer side",
    "wait bearing",
    "search side",
    "recover bearing",
)
SIZE: Final = len(SPEED_SIGHTS) + len(TURN_SIGHTS)
MOST: Final = (0.4, 0.8)  # [m/s], [rad/s] largest correction
FASTEST: Final = (-0.25, 0.8)  # [m/s] backwards and forwards, as the scripted follower
_FAR_M: Final = 3.0
_AHEAD: Final = slice(2, 6)  # front sonars
_LEFT, _RIGHT = slice(0, 3), slice(5, 8)


class LearnedFollower:
    """Person following like `FollowPerson`, with learned corrections of the commands.

    For your own weights, derive a subclass with another `file`.

    Args:
        weights: (16,) for `SPEED_SIGHTS` followed by `TURN_SIGHTS`; None for those of the file.
    """

    file: Path = Path(__file__).with_name("follower.npz")

    def __init__(self, weights: Weights | None = None) -> None:
        self._weights = load_weights(self.file) if weights is None else weights
        self._config = FollowConfig()
        self._written = FollowPerson(self._config)

    @property
    def mode(self) -> str:
        """Current activity."""
        return self._written.mode

    @property
    def reason(self) -> str:
        """Reason for the mode."""
        return self._written.reason

    @property
    def following(self) -> int | None:
        """Id of the followed track."""
        return self._written.following

    def command(self, percept: Percept) -> Command:
        """Return the corrected command; invalid percepts are not corrected."""
        written = self._written.command(percept)
        if self.mode == "blind":
            return written
        speed_sights, turn_sights = sights(percept, self._written.state, self._config)
        of_speed, of_turn = np.split(self._weights, [len(SPEED_SIGHTS)])
        speed = written.linear_m_s + MOST[0] * math.tanh(speed_sights @ of_speed)
        turn = written.angular_rad_s + MOST[1] * math.tanh(turn_sights @ of_turn)
        most_turn = self._config.max_turn_rad_s
        return Command(
            linear_m_s=min(max(speed, FASTEST[0]), FASTEST[1]),
            angular_rad_s=min(max(turn, -most_turn), most_turn),
        )


def sights(percept: Percept, state: FollowState, config: FollowConfig) -> tuple[Weights, Weights]:
    """Return the features for correcting the speed (9,) and the turn rate (7,), each in about -1..1.

    Features that do not apply in the follower's mode are 0.
    """
    follows, waits, recovers = (float(state.mode == mode) for mode in ("follow", "wait", "recover"))
    near = np.minimum(percept.sonar_m, _FAR_M) / _FAR_M
    speed = [0.0] * len(SPEED_SIGHTS)
    turn = [0.0] * len(TURN_SIGHTS)
    if state.target is not None:
        target = state.target
        off, drift = target.bearing_rad / 0.6, target.drift_rad_s / 0.6
        too_far = min(max(distance_error(target.height, config), -1.0), 1.0)
        walking, driving = state.walking_m_s / 0.8, percept.linear_m_s / 0.8
        seen = (1.0, too_far, walking, driving, abs(off), abs(drift), float(near[_AHEAD].min()))
        speed[:7] = [follows * sight for sight in seen]
        turn[:3] = [follows * sight for sight in (off, drift, percept.angular_rad_s / 1.2)]
        turn[4] = waits * off
    speed[7:] = [waits, recovers]
    turn[3] = (follows or recovers) * float(near[_LEFT].min() - near[_RIGHT].min())
    turn[5] = state.side * float(state.mode == "search")
    turn[6] = recovers * (0.0 if state.place is None else state.place.bearing_rad / 0.6)
    return np.clip(speed, -2.0, 2.0), np.clip(turn, -2.0, 2.0)


def load_weights(file: Path) -> Weights:
    """Load weights, without pickle.

    Raises:
        BadInput: the file is missing, or does not contain such weights.
    """
    with open_archive(file, "python -m examples.learning.train") as stored:
        weights = np.asarray(stored["weights"], np.float64)
    if weights.shape != (SIZE,) or not np.isfinite(weights).all():
        raise BadInput(f"{file}: weights must be ({SIZE},) finite numbers, got {weights.shape}")
    return weights
