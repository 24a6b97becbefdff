"""The environments by name: gymnasium finds them through the entry point `gymnasium.envs`.

Gymnasium 1.0 and later load no entry points. There this module is named before the environment, or imported:
`gymnasium.make("scenarios.environments.register:peopleboy/PersonFollowing-v0")`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

# Not from gymnasium itself, which is half imported when it loads entry points.
from gymnasium.envs.registration import register, registry

ENVIRONMENTS: Final[Mapping[str, Mapping[str, str]]] = {
    "peopleboy/PersonFollowing-v0": {"scenario": "single_follow", "task": "follow"},
    "peopleboy/CorridorFollowing-v0": {"scenario": "corridor_straight", "task": "corridor"},
    "peopleboy/Patrol-v0": {"scenario": "patrol_corridor", "task": "patrol"},
}
"""Each environment's scenario and task by its name."""


def register_environments() -> None:
    """Tell gymnasium the environments that it does not know yet."""
    for name, settings in ENVIRONMENTS.items():
        if name not in registry:
            register(
                name, entry_point="scenarios.environments.environment:PeopleBoyEnv", kwargs=dict(settings)
            )


register_environments()
