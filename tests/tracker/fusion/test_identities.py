from peopleboy.tracker.frame import PANORAMA, THERMAL
from peopleboy.tracker.fusion.handover_links import YOUNG_S, Identities
from tests.helpers.runs.hand_made_tracks import track

OLD, YOUNG = 5.0, YOUNG_S / 2
WARM, AROUND, OTHER = (THERMAL, 1), (PANORAMA, 2), (THERMAL, 5)


def agree(follower_age, leader_age):
    """The number that two tracks have which were 1 and 2 before."""
    identities = Identities(number={WARM: 1, AROUND: 2}, _newest=2)
    follower, leader = (WARM, track(1, age_s=follower_age)), (AROUND, track(2, age_s=leader_age))
    identities.agree(follower, leader, [WARM, AROUND])
    (number,) = set(identities.number.values())
    return number


def test_a_young_number_gives_way_and_of_two_old_ones_the_followers():
    assert agree(OLD, OLD) == 2
    assert agree(YOUNG, OLD) == 2
    assert agree(YOUNG, YOUNG) == 2
    assert agree(OLD, YOUNG) == 1


def test_whoever_else_has_the_number_in_that_camera_gets_a_new_one():
    identities = Identities(number={WARM: 3, AROUND: 1, OTHER: 1}, _newest=3)
    identities.agree((WARM, track(1)), (AROUND, track(2)), [WARM, AROUND, OTHER])
    assert identities.number == {AROUND: 1, WARM: 1, OTHER: 4}


def test_who_is_away_and_had_the_number_does_not_come_back_with_it():
    identities = Identities(number={WARM: 3, AROUND: 1, OTHER: 1}, _newest=3)
    identities.agree((WARM, track(1)), (AROUND, track(2)), [WARM, AROUND])
    assert identities.number == {AROUND: 1, WARM: 1}


def test_who_agrees_already_keeps_the_number_and_so_does_everybody_else():
    before = {WARM: 2, AROUND: 2, OTHER: 7}
    identities = Identities(number=dict(before), _newest=7)
    identities.agree((WARM, track(1, age_s=YOUNG)), (AROUND, track(2)), [WARM, AROUND, OTHER])
    assert identities.number == before


def named(known, number, guessed=None):
    """The numbers after two tracks of the thermal image are there, the first of them new; what was asked."""
    identities, asked = Identities(number=dict(number), _newest=9), []

    def guess(one, present):
        asked.append((one.id, set(present)))
        return guessed

    identities.name(THERMAL, [track(1), track(5)], known, guess)
    return identities.number[WARM], asked


def test_a_new_track_has_the_number_of_its_mate_or_that_of_who_is_guessed_or_a_new_one():
    there = {OTHER: 7, AROUND: 3}
    assert named({1: AROUND}, there) == (3, [])
    assert named({}, there, guessed=4) == (4, [(1, {7})])
    assert named({}, there) == (10, [(1, {7})])
    assert named({1: AROUND}, {OTHER: 7}, guessed=4) == (4, [(1, {7})])


def test_no_new_track_has_a_number_that_its_camera_has_already():
    assert named({1: AROUND}, {OTHER: 7, AROUND: 7})[0] == 10
    assert named({}, {OTHER: 7}, guessed=7)[0] == 10
