from dataclasses import replace

import pytest

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.truth.scenes import is_seen
from peopleboy.sim.world import SimulatedWorld


def test_an_upright_body_is_about_where_the_exact_boxes_and_pixels_say() -> None:
    with SimulatedWorld(load_scenario("crossing_2").world(0)) as world:
        compared = 0
        for _ in range(60):
            world.step(0.0, 0.0)
            exact = {person.id: person for person in world.truth().people}
            for person in world.scene().people:
                truth = exact[person.id]
                if truth.inside_fraction > 0.99 and truth.occluded_fraction < 0.01:
                    left, top, width, height = truth.box
                    assert person.box[1] == pytest.approx(top, abs=0.05 * height)
                    assert person.box[3] == pytest.approx(height, rel=0.06)
                    assert person.box[0] + person.box[2] / 2 == pytest.approx(
                        left + width / 2, abs=0.5 * width
                    )
                    assert person.free_ray_share == 1.0
                    compared += 1
        assert compared > 10


def test_rays_and_pixels_agree_on_who_is_seen() -> None:
    agree = []
    with SimulatedWorld(load_scenario("crossing_2").world(0)) as world:
        for _ in range(150):
            world.step(0.0, 0.0)
            exact = {person.id: person for person in world.truth().people}
            agree += [
                person.is_seen == is_seen(exact[person.id].visible_fraction)
                for person in world.scene().people
                if exact[person.id].is_in_image
            ]
    assert len(agree) > 100
    assert sum(agree) > 0.9 * len(agree)


@pytest.mark.parametrize(("share", "expected"), [(0.0, False), (0.3, False), (0.31, True), (1.0, True)])
def test_who_is_seen_shows_more_than_the_least_share(share: float, expected: bool) -> None:
    assert is_seen(share) is expected


def test_a_world_without_images_moves_like_one_with_them_and_refuses_to_look() -> None:
    config = load_scenario("corridor_meeting").world(1)
    with SimulatedWorld(config) as seeing, SimulatedWorld(replace(config, renderer="none")) as blind:
        for _ in range(30):
            seeing.step(0.4, 0.2)
            blind.step(0.4, 0.2)
        one, other = seeing.scene(), blind.scene()
        assert (one.robot.x, one.robot.y) == pytest.approx((other.robot.x, other.robot.y), abs=1e-3)
        assert one.people[0].position_m == pytest.approx(other.people[0].position_m, abs=1e-3)
        with pytest.raises(BadInput, match="no images"):
            blind.truth()
