"""What sets one person apart from the next: warmth, glasses, straps, how they wear their clothes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from peopleboy.sim.people.body.outfit import Outfit
from peopleboy.sim.people.person_config import PersonConfig

Strap = Literal["none", "left", "right", "both"]

_GLASSES = 0.36  # of adults wear them all the time (Institut für Demoskopie Allensbach, Brillenstudie 2014)
_BEARD = 0.35  # of men, a stubble or more: our choice
_USUAL_SPEED_M_S = 1.2
_K_PER_M_S = 1.2  # who walks faster is warmer
_OPEN_JACKET, _BELT, _PHONE, _PARTED = 0.55, 0.5, 0.3, 0.6


@dataclass(frozen=True, slots=True, kw_only=True)
class Traits:
    """One person's own.

    Attributes:
        warmer_k: [K] skin against other people's, clothes by their share of it.
        hands_k, nose_k: [K] hands and feet, and the nose, against other people's.
        sweat: 0..1 how wet the back is.
        glasses, beard, open_jacket, belt, phone: whether there is one.
        strap: of what is carried, from which shoulder it comes.
        parting: where the hair is parted, -1 the right side, 1 the left, 0 nowhere.
    """

    warmer_k: float
    hands_k: float
    nose_k: float
    sweat: float
    glasses: bool
    beard: bool
    open_jacket: bool
    belt: bool
    phone: bool
    strap: Strap
    parting: float


def draw_traits(config: PersonConfig, outfit: Outfit, air_c: float, rng: np.random.Generator) -> Traits:
    """Draw a person's traits; speed and warm air make them warmer and wetter."""
    speeds = [waypoint.speed_m_s for waypoint in config.path[1:]]
    busy_k = _K_PER_M_S * (float(np.mean(speeds)) - _USUAL_SPEED_M_S) if speeds else 0.0
    warmer_k = float(np.clip(busy_k, -0.8, 1.2) + 0.7 * _normal(rng))
    cold_hands_k = 1.3 * _normal(rng)
    parting = float(rng.choice([-1.0, 1.0])) * float(rng.uniform() < _PARTED)
    return Traits(
        warmer_k=warmer_k,
        hands_k=cold_hands_k,
        nose_k=0.5 * cold_hands_k + 0.5 * _normal(rng),
        sweat=float(np.clip(0.08 * (air_c - 24.0) + 0.3 * busy_k + 0.2 * _normal(rng), 0.0, 1.0)),
        glasses=bool(rng.uniform() < _GLASSES),
        beard=bool(rng.uniform() < _BEARD) and config.sex == "male",
        open_jacket=bool(rng.uniform() < _OPEN_JACKET),
        belt=bool(rng.uniform() < _BELT),
        phone=bool(rng.uniform() < _PHONE),
        strap=_strap(outfit),
        parting=parting,
    )


def _strap(outfit: Outfit) -> Strap:
    """A bag at one side hangs from the other shoulder."""
    if outfit.carried == "shoulder_bag":
        return "left" if outfit.side == "right" else "right"
    return "both" if outfit.carried == "rucksack" else "none"


def _normal(rng: np.random.Generator) -> float:
    """A normal draw whose tails are cut off."""
    return float(np.clip(rng.normal(), -2.0, 2.0))
