import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.check import crosses
from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.files.routes import find_route, route_m
from peopleboy.sim.places.floor_plan import Rectangle
from peopleboy.sim.places.place_config import RoomConfig, lay_out

FLOOR = lay_out(RoomConfig(kind="room", length_m=10.0, width_m=10.0))
START, END = (1.0, 0.0), (9.0, 0.0)


def test_without_rectangles_the_route_is_the_line() -> None:
    assert find_route(FLOOR, [], START, END) == (START, END)


def test_a_route_around_a_square_has_the_length_of_the_closed_form() -> None:
    square = Rectangle(4.0, -1.0, 6.0, 1.0)
    route = find_route(FLOOR, [square], START, END)
    assert route is not None
    assert route_m(route) == pytest.approx(2.0 * math.hypot(3.0, 1.0) + 2.0, abs=0.05)
    assert len(route) == 4


def test_a_route_crosses_no_rectangle_and_none_leads_through_a_closed_wall() -> None:
    rng = np.random.default_rng(0)
    for _ in range(20):
        corners = rng.uniform((2.0, -4.5), (7.0, 3.0), (8, 2))
        boxes = [
            Rectangle(x, y, x + w, y + h)
            for (x, y), (w, h) in zip(corners, rng.uniform(0.1, 1.5, (8, 2)), strict=True)
        ]
        route = find_route(FLOOR, boxes, START, END)
        assert route is not None
        assert not any(crosses(box, a, b) for box in boxes for a, b in pairwise(route))
        assert route_m(route) >= math.dist(START, END)
    assert find_route(FLOOR, [Rectangle(5.0, -5.0, 5.1, 5.0)], START, END) is None


BEHIND: dict[str, Any] = {
    "name": "behind",
    "description": "A block stands in the way.",
    "duration_s": 20.0,
    "place": {"kind": "room", "length_m": 8.0, "width_m": 6.0},
    "things": [{"kind": "block", "at_m": [4.0, 0.0], "size_m": [0.3, 4.0, 2.0]}],
    "people": [{"name": "eve", "path": [{"at_m": [2.0, 1.0]}, {"at_m": [6.0, 1.0], "speed_m_s": 0.7}]}],
    "robot": {"at_m": [1.0, -2.0]},
}


def test_a_path_leads_around_what_is_in_the_way_and_its_resolved_file_has_the_corners() -> None:
    with pytest.raises(BadInput, match="or route: true"):
        parse_scenario(BEHIND, source="my.yaml", folder=Path())
    eve = BEHIND["people"][0] | {"route": True, "jitter_m": 0.1}
    scenario = parse_scenario(BEHIND | {"people": [eve]}, source="my.yaml", folder=Path())
    for seed in range(3):
        (person,) = scenario.world(seed).people
        assert [waypoint.speed_m_s for waypoint in person.path[1:]] == [0.7, 0.7, 0.7]
        assert all(waypoint.at_m[1] == pytest.approx(2.21) for waypoint in person.path[1:-1])
        resolved = parse_scenario(scenario.resolved(seed), source="run.yaml", folder=Path())
        assert resolved.world(seed).people == (person,)
