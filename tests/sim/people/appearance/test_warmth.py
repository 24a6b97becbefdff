import numpy as np
import pytest

from peopleboy.sim.people.appearance.finisher import (
    ROOM_C,
    WARMEST_SKIN_C,
    bare_c,
    cloth_c,
    share_of_skin,
    under_cloth_c,
    wind_loss,
)
from peopleboy.sim.people.body.clothes import BOTTOMS, SHOES, SKIN_C, TOPS

AIR_C = np.arange(-5.0, 40.5, 0.5)
GARMENTS = {**TOPS, **BOTTOMS, **SHOES}


@pytest.mark.parametrize("name", GARMENTS)
def test_in_a_room_clothes_are_as_the_catalogue_says(name: str) -> None:
    garment = GARMENTS[name]
    for part in garment.covers:
        assert cloth_c(garment.temperature_c, part, ROOM_C) == pytest.approx(garment.temperature_c, abs=1e-9)


@pytest.mark.parametrize("part", SKIN_C)
def test_in_a_room_skin_is_as_the_catalogue_says_and_follows_the_air(part: str) -> None:
    assert bare_c(SKIN_C[part], part, ROOM_C) == SKIN_C[part]
    skin = np.array([bare_c(SKIN_C[part], part, air_c) for air_c in AIR_C])
    assert (np.diff(skin) >= 0.0).all()
    assert skin.max() <= WARMEST_SKIN_C
    # Skin damps what the air does.
    assert np.diff(skin).max() / 0.5 < 1.0


@pytest.mark.parametrize("name", GARMENTS)
def test_a_garment_lies_between_air_and_skin_at_the_share_that_its_insulation_gives(name: str) -> None:
    garment = GARMENTS[name]
    part = garment.covers[0]
    shares = []
    for air_c in (-5.0, 10.0, 21.0, 30.0):
        surface, skin = cloth_c(garment.temperature_c, part, air_c), under_cloth_c(part, air_c)
        assert air_c < surface < skin
        shares.append((surface - air_c) / (skin - air_c))
    # 1 / (1 + h R) with the surface's h of 8.5 W / (m2 K): from a stocking to a winter jacket and to boots.
    assert shares == pytest.approx([shares[0]] * 4)
    resistance = (1.0 / shares[0] - 1.0) / 8.5
    assert 0.0 < resistance < 0.25


def test_the_cold_takes_hands_more_than_faces_and_faces_more_than_covered_skin() -> None:
    change = {part: bare_c(33.0, part, 0.0) - 33.0 for part in ("left_hand", "head", "chest", "left_foot")}
    assert change["left_hand"] < -8.0 < change["head"] < -3.0 < change["chest"] < -1.5


def test_thick_clothes_lose_more_of_a_cold_day_than_thin_ones() -> None:
    thin, thick = (GARMENTS[name].temperature_c for name in ("t_shirt", "jacket"))
    assert cloth_c(thin, "chest", 0.0) - cloth_c(thick, "chest", 0.0) > 2.0 * (thin - thick)


def test_wind_cools_clothes_towards_the_air_and_no_wind_does_not() -> None:
    assert wind_loss(0.05) == 1.0
    assert wind_loss(1.0) == pytest.approx((12.1 + 4.5) / 8.5)
    # By the catalogue's own r: the cloth's resistance stays, the surface loses more.
    r = share_of_skin(30.6)
    resistance = (1.0 - r) / r
    windy = cloth_c(30.6, "chest", 21.0, 2.0)
    assert (windy - 21.0) / (under_cloth_c("chest", 21.0) - 21.0) == pytest.approx(
        1.0 / (1.0 + 2.0 * resistance)
    )
    assert cloth_c(30.6, "chest", 21.0) == pytest.approx(30.6, abs=1e-9)
