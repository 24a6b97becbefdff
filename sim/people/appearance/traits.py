"""Individual traits of people: usual clothes by sex and air temperature, glasses, straps, body warmth."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from peopleboy.sim.people.body.anthropometry import Sex
from peopleboy.sim.people.body.bodies import Age
from peopleboy.sim.people.body.clothes import Clothes
from peopleboy.sim.people.body.outfit import Outfit
from peopleboy.sim.people.person_config import PersonConfig

Strap = Literal["none", "left", "right", "both"]

_GLASSES = 0.36  # of adults always wear them (Institut für Demoskopie Allensbach, Brillenstudie 2014)
_BEARD = 0.35  # share of men with a stubble or more: our choice
_USUAL_SPEED_M_S = 1.2
_K_PER_M_S = 1.2  # faster walkers are warmer
_OPEN_JACKET, _BELT, _PHONE, _PARTED = 0.55, 0.5, 0.3, 0.6


@dataclass(frozen=True, slots=True, kw_only=True)
class Traits:
    """Individual traits of one person.

    Attributes:
        warmer_k: [K] skin temperature less that of the mean person; clothes take their share of it.
        hands_k, nose_k: [K] the same for hands and feet, and for the nose.
        sweat: 0..1 how wet the back is.
        glasses, beard, open_jacket, belt, phone: whether the person has one.
        strap: the shoulder from which the strap of a bag comes.
        parting: side on which the hair is parted, -1 the right side, 1 the left, 0 nowhere.
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
        beard=bool(rng.uniform() < _BEARD) and config.sex == "male" and config.age != "child",
        open_jacket=bool(rng.uniform() < _OPEN_JACKET),
        belt=bool(rng.uniform() < _BELT),
        phone=bool(rng.uniform() < _PHONE),
        strap=_strap(outfit),
        parting=parting,
    )


def _strap(outfit: Outfit) -> Strap:
    """Return the shoulder of a bag's strap: a bag at one side hangs from the other shoulder."""
    if outfit.carried == "shoulder_bag":
        return "left" if outfit.side == "right" else "right"
    return "both" if outfit.carried == "rucksack" else "none"


def _normal(rng: np.random.Generator) -> float:
    """Draw from a normal distribution with truncated tails."""
    return float(np.clip(rng.normal(), -2.0, 2.0))


Shares = Mapping[str, float]

# Bald: 7.7 % of men have hardly any hair or none (GfK for Apotheken Umschau, 944 men, 2014); women hardly
# ever. Long hair on most women, on few men: our own count in street scenes. Caps depend on the weather.
HAIR: Final[Mapping[Sex, Shares]] = {
    "female": {"long": 0.72, "short": 0.28},
    "male": {"short": 0.86, "bald": 0.077, "long": 0.063},
}
# Hair in central Europe is mostly brown to dark blond, rarely red, and grey in a fifth of people; the palette
# has no further names.
HAIR_COLOURS: Final[Shares] = {
    "dark_brown": 0.36, "brown": 0.2, "blond": 0.2, "black": 0.08, "grey": 0.1, "light_grey": 0.06
}  # fmt: skip
# One woman in eight wears a skirt indoors, more in warm air; shorts depend on the temperature: our choice.
_BOTTOMS: Final[Mapping[Sex, Mapping[str, Shares]]] = {
    "female": {
        "cold": {"jeans": 0.55, "trousers": 0.25, "leggings": 0.16, "skirt": 0.04},
        "mild": {"jeans": 0.48, "trousers": 0.26, "leggings": 0.14, "skirt": 0.12},
        "warm": {"jeans": 0.26, "trousers": 0.16, "leggings": 0.12, "skirt": 0.2, "shorts": 0.26},
    },
    "male": {
        "cold": {"jeans": 0.62, "trousers": 0.38},
        "mild": {"jeans": 0.58, "trousers": 0.4, "shorts": 0.02},
        "warm": {"jeans": 0.3, "trousers": 0.2, "shorts": 0.5},
    },
}
# In the cold people wear the insulation that ISO 11079 requires: a jacket below about 12 degC.
_TOPS: Final[Mapping[str, Shares]] = {
    "cold": {"jacket": 0.72, "fleece": 0.13, "wool_jumper": 0.09, "striped_jumper": 0.03, "lab_coat": 0.03},
    "mild": {
        "shirt": 0.27, "checked_shirt": 0.11, "t_shirt": 0.17, "printed_t_shirt": 0.06, "wool_jumper": 0.14,
        "striped_jumper": 0.06, "fleece": 0.07, "jacket": 0.1, "lab_coat": 0.02,
    },
    "warm": {"t_shirt": 0.58, "printed_t_shirt": 0.18, "shirt": 0.16, "checked_shirt": 0.06, "jacket": 0.02},
}  # fmt: skip
_SHOES: Final[Mapping[str, Shares]] = {
    "cold": {"boots": 0.55, "trainers": 0.25, "leather_shoes": 0.2},
    "mild": {"trainers": 0.5, "leather_shoes": 0.34, "boots": 0.16},
    "warm": {"trainers": 0.54, "sandals": 0.28, "leather_shoes": 0.18},
}
_CAPS: Final[Shares] = {"cold": 0.4, "mild": 0.05, "warm": 0.1}
# Most clothes are black, white, grey or blue; bright ones are few.
_TOP_COLOURS: Final[Shares] = {
    "black": 0.2, "navy": 0.13, "white": 0.14, "grey": 0.14, "light_grey": 0.09, "blue": 0.07,
    "light_blue": 0.06, "khaki": 0.04, "green": 0.04, "brown": 0.03, "red": 0.03, "pink": 0.01,
    "purple": 0.01, "orange": 0.005, "yellow": 0.005,
}  # fmt: skip
_BOTTOM_COLOURS: Final[Mapping[str, Shares]] = {
    "jeans": {"blue": 0.62, "navy": 0.16, "black": 0.16, "light_blue": 0.06},
    "leggings": {"black": 0.8, "grey": 0.12, "navy": 0.08},
    "": {
        "black": 0.36, "grey": 0.18, "navy": 0.14, "khaki": 0.14, "brown": 0.08, "light_grey": 0.04,
        "blue": 0.04, "white": 0.02,
    },
}  # fmt: skip
_COLD_C, _WARM_C = 12.0, 25.0
_EITHER_SIDE_K = 4.0


def usual_clothes(rng: np.random.Generator, sex: Sex, air_c: float) -> Clothes:
    """Draw clothes that people of a sex usually wear in air of the given temperature [degC]."""
    season = _season(rng, air_c)
    bottom = _pick(rng, _BOTTOMS[sex][season])
    hair = "cap" if rng.uniform() < _CAPS[season] else _pick(rng, HAIR[sex])
    return Clothes(
        top=_pick(rng, _TOPS[season]),
        bottom=bottom,
        shoes=_pick(rng, _SHOES[season]),
        hair=hair,
        top_colour=_pick(rng, _TOP_COLOURS),
        bottom_colour=_pick(rng, _BOTTOM_COLOURS.get(bottom, _BOTTOM_COLOURS[""])),
        hair_colour="skin" if hair == "bald" else _pick(rng, _TOP_COLOURS if hair == "cap" else HAIR_COLOURS),
    )


def suit_age(clothes: Clothes, age: Age) -> Clothes:
    """Return clothes with the hair of an age group: no child is bald, and the hair of elders is grey."""
    if age == "child" and clothes.hair == "bald":
        return replace(clothes, hair="short", hair_colour="brown")
    if age == "elder" and clothes.hair in ("short", "long"):
        is_dark = clothes.hair_colour in ("dark_brown", "black", "grey")
        return replace(clothes, hair_colour="grey" if is_dark else "light_grey")
    return clothes


def _season(rng: np.random.Generator, air_c: float) -> str:
    """Draw the season that a person dresses for; its limits differ by a few kelvin between people."""
    felt_c = air_c + float(rng.uniform(-_EITHER_SIDE_K, _EITHER_SIDE_K))
    if felt_c < _COLD_C:
        return "cold"
    return "warm" if felt_c > _WARM_C else "mild"


def _pick(rng: np.random.Generator, shares: Shares) -> str:
    return str(rng.choice(list(shares), p=np.array(list(shares.values())) / sum(shares.values())))
