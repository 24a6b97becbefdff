"""Episodes of small environments, played and saved."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import yaml

from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from tests.helpers.runs.exported import FOLLOWING

SHORT = FOLLOWING | {"duration_s": 1.0, "faults": []}
ARRIVING = FOLLOWING | {
    "faults": [],
    "robot": FOLLOWING["robot"] | {"behaviour": "go_to", "goal_m": [1.4, 0.0]},
}


def played(folder: Path, steps: int, scene: dict[str, Any] = FOLLOWING, **settings: Any) -> dict[str, Any]:
    """Play an episode, and save it as `folder`."""
    path = folder.parent / f"{scene['name']}.yaml"
    path.write_text(yaml.safe_dump(scene), encoding="utf-8")
    env = PeopleBoyEnv(path, **settings)
    found: dict[str, Any] = {"observations": [env.reset(seed=3)[0]], "actions": [], "rewards": []}
    for step in range(steps):
        action = np.array([0.5, 0.1 * np.sin(step)], np.float32)
        observation, reward, found["ends"], found["is_cut"], _ = env.step(action)
        found["observations"].append(observation)
        found["actions"].append(action)
        found["rewards"].append(reward)
        if found["ends"] or found["is_cut"]:
            break
    env.save(folder, record=False)
    env.close()
    return found
