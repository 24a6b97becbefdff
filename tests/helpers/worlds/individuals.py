"""People of full detail for tests: each with a gait, clothes and bags of its own."""

from dataclasses import replace

from peopleboy.random_streams import stream
from peopleboy.sim.people.appearance.finisher import Finisher
from peopleboy.sim.people.person import Person
from peopleboy.sim.people.person_config import PersonConfig, Waypoint


def make_individual(
    seed: int,
    *,
    manner: dict[str, object] | None = None,
    outfit: dict[str, object] | None = None,
    **settings: object,
) -> Person:
    """A person whose manner and outfit are drawn by a seed, but for what is given."""
    config = PersonConfig(**({"name": "ann", "path": (Waypoint(at_m=(0.0, 0.0)),)} | settings))
    finisher = Finisher(config, 21.0, stream(seed, "looks"))
    finisher.manner = replace(finisher.manner, **(manner or {}))
    finisher.outfit = replace(finisher.outfit, **(outfit or {}))
    return Person(config, stream(seed, "person"), finisher)
