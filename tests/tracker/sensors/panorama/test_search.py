import math

from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.tracker.sensors.panorama.panorama_patches import promising_places
from tests.helpers.images.cardboard import Cardboard, scene_of

BEARINGS, DISTANCES = st.floats(-math.pi, math.pi), st.floats(1.4, 6.0)


def turned(one, other):
    return abs(math.remainder(one - other, math.tau))


@settings(max_examples=30)
@given(BEARINGS, DISTANCES)
def test_a_person_is_found_where_it_stands_also_across_the_seam(bearing, distance):
    found = promising_places(scene_of([Cardboard(distance, bearing)]).figures, 3)
    assert turned(found[0, 0], bearing) < math.radians(4)
    assert abs(found[0, 1] - distance) < 0.2 * distance + 0.1


@given(st.integers(0, 159), DISTANCES)
@settings(max_examples=20)
def test_turning_by_whole_steps_of_the_search_turns_what_is_found(steps, distance):
    people = [Cardboard(distance, 0.3), Cardboard(2.5, 2.9), Cardboard(4.0, -2.0)]
    here = promising_places(scene_of(people).figures, 3)
    there = promising_places(scene_of(people, 3 * steps).figures, 3)
    assert len(here) == len(there) == 3
    for one in people:
        found = [turned(one.bearing_rad - steps * math.tau / 160, bearing) for bearing in there[:, 0]]
        assert min(found) < math.radians(4)
        assert min(turned(one.bearing_rad, bearing) for bearing in here[:, 0]) < math.radians(4)


def test_in_an_empty_hall_nothing_is_promising():
    assert promising_places(scene_of([]).figures, 3).shape == (0, 2)


def test_so_many_are_found_at_most_each_at_a_bearing_of_its_own():
    people = [Cardboard(3.0, bearing) for bearing in (-2.0, -0.5, 0.6, 2.2)]
    figures = scene_of(people).figures
    for most in (0, 1, 2, 4, 9):
        found = promising_places(figures, most)
        assert len(found) == min(most, 4)
    nearest = [min(turned(one.bearing_rad, bearing) for bearing in found[:, 0]) for one in people]
    assert max(nearest) < math.radians(4)


def test_who_has_been_found_is_not_found_again():
    scene = scene_of([Cardboard(2.5, 1.0), Cardboard(4.0, -1.0)])
    scene.cover(1.0, 2.5)
    (other,) = promising_places(scene.figures, 3)
    assert turned(other[0], -1.0) < math.radians(4)
    scene.cover(-1.0, 4.0)
    assert len(promising_places(scene.figures, 3)) == 0
