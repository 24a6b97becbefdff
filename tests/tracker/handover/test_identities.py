from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.handover.identities import YOUNG_S, Identities
from peopleboy.tracker.panoramic.people.panoramic_tracker import PANORAMA
from tests.helpers.runs.hand_made_tracks import track

OLD, YOUNG = 5.0, YOUNG_S / 2


def name(identities, camera, tracks, known):
    identities.name(camera, tracks, known, guess=lambda _: None)


def named(*cameras_and_ids):
    identities = Identities()
    for camera, number in cameras_and_ids:
        name(identities, camera, [track(number)], {})
    return identities


def test_tracks_are_numbered_as_they_come_and_keep_their_numbers():
    identities = named((PANORAMA, 4), (THERMAL, 4), (PANORAMA, 2))
    assert identities.number == {(PANORAMA, 4): 1, (THERMAL, 4): 2, (PANORAMA, 2): 3}
    name(identities, PANORAMA, [track(4), track(2)], {})
    assert len(set(identities.number.values())) == 3


def test_who_agrees_with_a_known_track_has_its_number_from_the_first_frame_on():
    identities = named((PANORAMA, 3))
    name(identities, THERMAL, [track(8)], {8: (PANORAMA, 3)})
    assert identities.number[THERMAL, 8] == identities.number[PANORAMA, 3] == 1


def test_two_of_one_camera_never_get_the_same_number():
    identities = named((PANORAMA, 3))
    same = {8: (PANORAMA, 3), 9: (PANORAMA, 3)}
    name(identities, THERMAL, [track(8), track(9)], same)
    assert identities.number[THERMAL, 8] == 1 != identities.number[THERMAL, 9]


def agree(follower_age, leader_age):
    identities = named((THERMAL, 1), (PANORAMA, 2))
    follower = (THERMAL, 1), track(1, age_s=follower_age)
    leader = (PANORAMA, 2), track(2, age_s=leader_age)
    identities.agree(follower, leader, [follower[0], leader[0]])
    numbers = identities.number
    assert numbers[THERMAL, 1] == numbers[PANORAMA, 2]
    return numbers[THERMAL, 1]


def test_a_young_number_gives_way_and_of_two_old_ones_the_followers():
    assert agree(OLD, OLD) == 2
    assert agree(YOUNG, OLD) == 2
    assert agree(YOUNG, YOUNG) == 2
    assert agree(OLD, YOUNG) == 1


def test_whoever_else_has_the_number_in_that_camera_gets_a_new_one():
    identities = named((PANORAMA, 2))
    name(identities, THERMAL, [track(5)], {5: (PANORAMA, 2)})
    name(identities, THERMAL, [track(5), track(6)], {})
    follower, leader = ((THERMAL, 6), track(6)), ((PANORAMA, 2), track(2))
    identities.agree(follower, leader, [(THERMAL, 5), (THERMAL, 6), (PANORAMA, 2)])
    assert identities.number == {(PANORAMA, 2): 1, (THERMAL, 6): 1, (THERMAL, 5): 3}


SEEN = st.sets(st.integers(1, 4), min_size=1)


@settings(max_examples=200)
@given(st.lists(st.tuples(SEEN, SEEN, st.floats(0, 3), st.floats(0, 3)), max_size=8), st.randoms())
def test_in_no_camera_two_tracks_ever_have_one_number(history, chance):
    """Whoever agrees with whomever, and comes and goes, in any order."""
    identities = Identities()
    for warm, around, age, other_age in history:
        one, other = chance.choice(sorted(warm)), chance.choice(sorted(around))
        name(identities, PANORAMA, [track(k) for k in around], {other: (THERMAL, one)})
        name(identities, THERMAL, [track(k) for k in warm], {one: (PANORAMA, other)})
        present = [*((THERMAL, k) for k in warm), *((PANORAMA, k) for k in around)]
        follower, leader = track(one, age_s=age), track(other, age_s=other_age)
        identities.agree(((THERMAL, one), follower), ((PANORAMA, other), leader), present)
        assert identities.number[THERMAL, one] == identities.number[PANORAMA, other]
        for camera, seen in ((THERMAL, warm), (PANORAMA, around)):
            assert len({identities.number[camera, k] for k in seen}) == len(seen)
