"""Names of the environments, for `gymnasium.make` after `import peopleboy`."""

from collections.abc import Mapping
from typing import Final

from gymnasium.envs.registration import register, registry

ENVIRONMENTS: Final[Mapping[str, Mapping[str, str]]] = {
    "peopleboy/PersonFollowing-v0": {"scenario": "single_follow", "task": "follow"},
    "peopleboy/CorridorFollowing-v0": {"scenario": "corridor_straight", "task": "corridor"},
    "peopleboy/Patrol-v0": {"scenario": "patrol_corridor", "task": "patrol"},
    "peopleboy/GoTo-v0": {"scenario": "go_to_foyer", "task": "go_to"},
}
"""Each environment's scenario and task by its name."""

MAX_EPISODE_STEPS: Final = 1125
"""Steps of an episode: 75 s, the duration of these scenarios, at 15 Hz."""

_ENTRY: Final = "peopleboy.scenarios.environments.environment:PeopleBoyEnv"
_VECTOR_ENTRY: Final = "peopleboy.scenarios.environments.vector_environment:PeopleBoyVectorEnv"


def register_environments() -> None:
    """Register the environments with gymnasium; what an environment needs is imported when it is made."""
    for name, settings in ENVIRONMENTS.items():
        if name not in registry:
            register(
                name,
                entry_point=_ENTRY,
                vector_entry_point=_VECTOR_ENTRY,
                max_episode_steps=MAX_EPISODE_STEPS,
                kwargs=dict(settings),
            )
