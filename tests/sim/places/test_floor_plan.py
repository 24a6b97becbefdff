from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from peopleboy.bad_input import BadInput
from peopleboy.sim.places.floor_plan import (
    LOBBY_MARGIN_M,
    WALL_M,
    Door,
    FloorPlan,
    Rectangle,
    subtract,
)
from peopleboy.sim.places.make_place import build_place
from peopleboy.sim.places.place_config import l_corridor, straight_corridor, t_corridor
from tests.helpers.calls.refused import refused
from tests.helpers.worlds.boxes import fighting_faces, first_hit, world_boxes

sizes = st.floats(3.0, 12.0).map(lambda size: round(size, 2))
widths = st.floats(1.6, 2.9).map(lambda width: round(width, 2))
rectangles = st.builds(
    lambda x, y, w, h: Rectangle(x, y, x + w, y + h),
    *[st.integers(-5, 5)] * 2,
    *[st.integers(1, 6)] * 2,
)


@st.composite
def plans(draw: st.DrawFn) -> FloorPlan:
    plan = draw(
        st.one_of(
            st.builds(straight_corridor, sizes, widths),
            st.builds(l_corridor, sizes, sizes, widths, st.sampled_from(["left", "right"])),
            st.builds(t_corridor, sizes, sizes, widths),
        )
    )
    walls = plan.walls()
    doors: list[Door] = []
    for _ in range(draw(st.integers(0, 3))):
        wall = draw(st.sampled_from(walls))
        low, high = wall.side.span(wall.area)
        along = low + (high - low) * draw(st.floats(0.1, 0.9))
        door = Door(wall=wall.name, along_m=round(along, 2), is_open=draw(st.booleans()))
        try:
            replace(plan, doors=(*doors, door))
        except BadInput:
            continue
        doors.append(door)
    return replace(plan, doors=tuple(doors))


@given(rectangles, st.lists(rectangles, max_size=4))
def test_cutting_holes_keeps_exactly_the_points_outside_all_holes(
    block: Rectangle, holes: list[Rectangle]
) -> None:
    pieces = subtract(block, tuple(holes))
    for x in np.arange(-5.5, 12.0):
        for y in np.arange(-5.5, 12.0):
            expected = block.contains(x, y) and not any(hole.contains(x, y) for hole in holes)
            assert sum(piece.contains(x, y) for piece in pieces) == int(expected)


@given(plans())
@settings(max_examples=60, deadline=None)
def test_walls_overlap_neither_each_other_nor_the_floor(plan: FloorPlan) -> None:
    blocks = [block for _, block in plan.wall_pieces()]
    for index, block in enumerate(blocks):
        assert not any(block.meets(other) for other in blocks[:index])
        assert not any(block.meets(area) for area in plan.walkable())


@given(plans())
@settings(max_examples=60, deadline=None)
def test_no_two_visible_faces_of_a_shell_lie_in_one_plane_and_overlap(plan: FloorPlan) -> None:
    assert fighting_faces(world_boxes(build_place(plan).fixtures)) == []


@given(plans(), st.integers(0, 2**32 - 1))
@settings(max_examples=60, deadline=None)
def test_a_place_is_closed_all_around(plan: FloorPlan, seed: int) -> None:
    boxes = world_boxes(build_place(plan).fixtures)
    rng = np.random.default_rng(seed)
    for area in plan.walkable():
        origin = np.array(
            [*rng.uniform((area.min_x, area.min_y), (area.max_x, area.max_y)), rng.uniform(0.1, 2.0)]
        )
        direction = rng.normal(size=3)
        assert first_hit(boxes, origin, direction / np.linalg.norm(direction)) < 60.0


@given(plans())
@settings(max_examples=60, deadline=None)
def test_obstacles_lie_inside_the_bounds(plan: FloorPlan) -> None:
    place = build_place(plan)
    min_x, min_y, max_x, max_y = place.bounds
    assert len(place.obstacles) == len(place.obstacle_names)
    assert np.all(place.obstacles[:, :2] >= np.array([min_x, min_y]) - 1e-9)
    assert np.all(place.obstacles[:, 2:] <= np.array([max_x, max_y]) + 1e-9)


@given(plans())
@settings(max_examples=60, deadline=None)
def test_an_open_door_leaves_its_whole_width_free(plan: FloorPlan) -> None:
    assume(any(door.is_open for door in plan.doors))
    walls = [Rectangle(*row) for row in build_place(plan).obstacles]
    for door in plan.doors:
        if door.is_open:
            opening = plan.opening(door)
            assert max(opening.max_x - opening.min_x, opening.max_y - opening.min_y) == pytest.approx(
                door.width_m
            )
            assert not any(wall.meets(opening.grown(0.05).cut(opening)) for wall in walls)
            assert not any(wall.meets(plan.lobby(door)) for wall in walls)


def test_a_lintel_begins_at_the_height_of_its_door() -> None:
    plan = replace(straight_corridor(6.0, 3.0), doors=(Door(wall="north", along_m=3.0),))
    lintel = next(box for box in world_boxes(build_place(plan).fixtures) if box.name == "door_1/lintel")
    assert lintel.low[2] == pytest.approx(2.05)
    assert lintel.high[2] > 2.7


def test_a_lobby_has_room_beside_its_door_to_stand_out_of_sight() -> None:
    plan = replace(straight_corridor(6.0, 3.0), doors=(Door(wall="east", along_m=0.0, width_m=1.0),))
    lobby = plan.lobby(plan.doors[0])
    assert lobby == Rectangle(6.0 + WALL_M, -0.5 - LOBBY_MARGIN_M, 6.0 + WALL_M + 1.5, 0.5 + LOBBY_MARGIN_M)


def test_the_corner_of_an_l_corridor_is_open() -> None:
    plan = l_corridor(8.0, 5.0, 2.0)
    assert {wall.name for wall in plan.walls()} == {
        "first_north",
        "first_south",
        "first_east",
        "first_west",
        "second_north",
        "second_east",
        "second_west",
    }
    blocks = [block for _, block in plan.wall_pieces()]
    assert not any(block.meets(Rectangle(6.0, 0.5, 8.0, 1.5)) for block in blocks)


@pytest.mark.parametrize(
    "door",
    [
        Door(wall="first_south", along_m=7.9),
        Door(wall="first_north", along_m=5.0),
        Door(wall="second_west", along_m=1.6),
    ],
)
def test_doors_that_do_not_fit_are_refused(door: Door) -> None:
    with refused(f"doors[0].along_m: {door.along_m:g}", f"'{door.wall}'"):
        replace(l_corridor(8.0, 5.0, 2.0), doors=(door,))


def test_doors_that_overlap_are_refused() -> None:
    doors = (Door(wall="north", along_m=3.0), Door(wall="north", along_m=3.5))
    with pytest.raises(BadInput, match="overlaps"):
        replace(straight_corridor(6.0, 3.0), doors=doors)
