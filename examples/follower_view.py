"""Observation of the learned follower: nine numbers about the followed person, and six sonars.

`tracks` and `truth` have the same format, so a policy trained on one can be evaluated on the other.
"""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

REPEAT = 3  # steps for which an action is repeated: five decisions per second
FRONT_SONARS = slice(1, 7)
SIZE = 15


class FollowerView(gymnasium.Wrapper):  # type: ignore[type-arg]
    """Wrapper that converts observations to (15,) numbers of about -1..1, and repeats each action for 0.2 s.

    The numbers are: visible or not; column, height, and their changes; time since last seen; side where last
    seen; speed; turn rate; the six front sonars. The followed track is kept until it ends.
    """

    def __init__(self, env: gymnasium.Env[Any, Any]) -> None:
        super().__init__(env)
        self.observation_space = spaces.Box(-2.0, 2.0, (SIZE,), np.float32)

    def reset(self, **settings: Any) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Start an episode without a followed person."""
        self._id, self._unseen, self._side = 0.0, 0, 0.0
        self._last = np.zeros(2)
        observation, info = self.env.reset(**settings)
        return self._view(observation), info

    def step(self, action: Any) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Repeat the action, and sum the rewards."""
        total = 0.0
        for _ in range(REPEAT):
            observation, reward, terminated, truncated, info = self.env.step(action)
            total += float(reward)
            if terminated or truncated:
                break
        return self._view(observation), total, terminated, truncated, info

    def _view(self, observation: dict[str, NDArray[Any]]) -> NDArray[np.float32]:
        rows = observation["tracks"].reshape(-1, 7)
        mine = rows[(rows[:, 0] == self._id) & (rows[:, 0] > 0)]
        row = mine[0] if len(mine) else rows[0]
        is_seen = row[0] > 0 and row[6] > 0
        now = row[1:3] if is_seen else self._last
        change = now - self._last if row[0] == self._id else np.zeros(2)
        self._id, self._last = float(row[0]), np.array(now)
        self._unseen = 0 if is_seen else self._unseen + 1
        self._side = float(np.sign(row[1])) if is_seen else self._side
        speed, turn_rate = observation["odometry"][4:]
        person = (is_seen, *(now * is_seen), *(5.0 * change), min(self._unseen / 50.0, 1.0), self._side)
        body = (speed / 0.8, turn_rate / 2.6, *(observation["sonar"][FRONT_SONARS] / 5.0))
        return np.clip(np.array((*person, *body), np.float32), -2.0, 2.0)
