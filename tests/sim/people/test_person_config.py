import math

import numpy as np
import pytest

from peopleboy.random_streams import stream
from peopleboy.sim.people.body.clothes import (
    BOTTOMS,
    HAIR,
    SHOES,
    TOPS,
    Clothes,
    dress,
    random_clothes,
)
from peopleboy.sim.people.body.postures import Posture
from peopleboy.sim.people.person_config import PersonConfig, Waypoint
from peopleboy.sim.shapes.materials import COLOURS, PatternKind
from tests.helpers.calls.refused import refused
from tests.helpers.worlds.walkers import make_person, settle

HERE = (Waypoint(at_m=(0.0, 0.0)),)


@pytest.mark.parametrize(
    ("settings", "named"),
    [
        ({"name": ""}, ("name",)),
        ({"height_m": 0.9}, ("person 'ann'.height_m: must be at least 1, got 0.9",)),
        ({"height_m": 2.1}, ("height_m: must be at most 2, got 2.1",)),
        ({"height_m": math.nan}, ("height_m", "nan")),
        ({"sex": "x"}, ("sex 'x'", "female, male")),
        ({"build": "tall"}, ("build 'tall'",)),
        ({"arms": "waving"}, ("arms 'waving'",)),
        ({"enter_s": -1.0}, ("enter_s", "-1.0")),
        ({"enter_s": math.nan}, ("enter_s", "nan")),
        ({"enter_s": 5.0, "leave_s": 5.0}, ("leave_s: 5 must be after enter_s 5",)),
        ({"path": ()}, ("path",)),
        ({"path": (*HERE, *HERE)}, ("path[1].at_m: (0.0, 0.0) repeats the previous point",)),
    ],
)
def test_a_person_that_cannot_be_is_refused_in_one_line(settings, named):
    with refused(*named):
        PersonConfig(**({"name": "ann", "path": HERE} | settings))


@pytest.mark.parametrize(
    ("settings", "named"),
    [
        ({"at_m": (math.nan, 0.0)}, ("at_m", "nan")),
        ({"speed_m_s": -1.0}, ("speed_m_s: must be at least 0.1, got -1.0",)),
        ({"speed_m_s": math.nan}, ("speed_m_s", "nan")),
        ({"pause_s": -1.0}, ("pause_s", "-1.0")),
        ({"face": (math.inf, 0.0)}, ("face", "inf")),
        ({"posture": "siting"}, ("posture 'siting'", "sitting")),
    ],
)
def test_a_waypoint_that_cannot_be_is_refused_in_one_line(settings, named):
    with refused(*named):
        Waypoint(**({"at_m": (0.0, 0.0)} | settings))


@pytest.mark.parametrize(
    ("settings", "named"),
    [
        ({"top": "t_shrit"}, ("'t_shrit'", "'t_shirt'")),
        ({"bottom": "kilt"}, ("'kilt'", "'skirt'")),
        ({"shoes": "clogs"}, ("'clogs'",)),
        ({"hair": "green"}, ("'green'",)),
        ({"top_colour": "bleu"}, ("'bleu'", "'blue'")),
        ({"bottom_colour": (0.1, 0.2, 1.2)}, ()),
        ({"hair_colour": (math.nan, 0.0, 0.0)}, ()),
    ],
)
def test_unknown_clothes_are_refused_with_a_hint(settings, named):
    with refused(*settings, *named):
        Clothes(**settings)


@pytest.mark.parametrize("seed", range(8))
def test_temperatures_lie_where_people_have_them(seed):
    rng = stream(seed, "clothes")
    clothes = random_clothes(rng)
    materials = dress(clothes, rng)
    assert 33.5 <= materials["head"].temperature_c <= 34.8
    assert 32.0 <= materials["left_hand"].temperature_c <= 33.5
    assert materials["left_hand"] == materials["right_hand"]
    assert 26.7 <= materials["chest"].temperature_c <= 31.2
    assert 24.7 <= materials["left_foot"].temperature_c <= 28.5
    if clothes.hair != "bald":
        assert materials["hair"].temperature_c < materials["head"].temperature_c - 2.5
    for material in materials.values():
        assert 0.2 <= material.variation_k <= 0.6
        assert 0.9 <= material.emissivity <= 1.0
        assert all(0.0 <= channel <= 1.0 for channel in (*material.rgb, *material.second_rgb))


def test_every_garment_fits_a_person_and_thick_ones_are_cooler():
    for top in TOPS:
        for bottom in BOTTOMS:
            make_person(clothes=Clothes(top=top, bottom=bottom))
    for shoes in SHOES:
        for hair in HAIR:
            make_person(clothes=Clothes(shoes=shoes, hair=hair))
    thickness = [g.thickness_m for g in TOPS.values() if g.thermal_pattern.kind is PatternKind.PLAIN]
    temperature = [g.temperature_c for g in TOPS.values() if g.thermal_pattern.kind is PatternKind.PLAIN]
    assert np.corrcoef(thickness, temperature)[0, 1] < -0.7


def test_short_sleeves_bare_the_forearms_and_a_coat_hides_the_trousers():
    rng = stream(0, "clothes")
    light = dress(Clothes(top="t_shirt", bottom="shorts"), rng)
    assert light["left_forearm"].temperature_c > light["left_upper_arm"].temperature_c + 1.0
    assert light["left_shin"].rgb == light["head"].rgb
    coat = dress(Clothes(top="lab_coat", bottom="jeans", bottom_colour="red"), rng)
    assert coat["left_thigh"].rgb == COLOURS["white"]
    assert coat["left_shin"].rgb == COLOURS["red"]


@pytest.mark.parametrize(
    ("top", "kind"), [("printed_t_shirt", PatternKind.PATCH), ("striped_jumper", PatternKind.STRIPES)]
)
def test_patterned_garments_fool_a_thermal_contour(top, kind):
    chest = dress(Clothes(top=top), stream(0, "clothes"))["chest"]
    assert chest.thermal_pattern.kind is kind
    assert 2.0 <= abs(chest.contrast_k) <= 3.0


def test_a_print_is_on_the_middle_of_the_chest():
    person = settle(make_person(height_m=1.8), 0.1)
    pose = person.poses()[[part.name for part in person.model.parts].index("chest")]
    shoulders, hips = person.joints()[5:7, 2].mean(), person.joints()[11:13, 2].mean()
    assert hips + 0.5 * (shoulders - hips) < pose[2, 3] < shoulders
    assert pose[:3, 0] @ [1.0, 0.0, 0.0] > 0.95


def test_the_same_generator_makes_the_same_person_and_another_does_not():
    way = (Waypoint(at_m=(0.0, 0.0)), Waypoint(at_m=(5.0, 1.0), pause_s=1.0, posture=Posture.BENDING))
    one, same, other = (settle(make_person(seed=s, path=way), 3.0) for s in (1, 1, 2))
    assert one.model.parts == same.model.parts
    np.testing.assert_array_equal(one.poses(), same.poses())
    np.testing.assert_array_equal(one.joints(), same.joints())
    assert one.model.parts != other.model.parts
    assert not np.allclose(one.poses(), other.poses(), atol=1e-4)
    np.testing.assert_array_equal(one.position, other.position)
