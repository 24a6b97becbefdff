from __future__ import annotations

from benchmarks.speed.full_detail import in_detail


def test_both_details_of_a_scenario_have_the_same_people_and_electronics_only_where_it_is_full() -> None:
    plain, full = (in_detail("glass_corridor", detail) for detail in ("plain", "full"))
    assert [person.path for person in plain.spec.people] == [person.path for person in full.spec.people]
    assert plain.world(0).robot.cameras["thermal"].gain == "fixed"
    assert full.world(0).robot.cameras["thermal"].gain == "plateau"
    assert (plain.world(0).detail, full.world(0).detail) == ("plain", "full")
