from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from peopleboy.sim.people.person_config import PersonConfig, Waypoint
from peopleboy.sim.places.furniture.place_things import build_thing
from peopleboy.sim.places.furniture.thing_config import ThingConfig
from peopleboy.sim.places.make_place import build_place
from peopleboy.sim.places.moving import Action, ActionKind, Mover, Stance
from peopleboy.sim.places.place import Place
from peopleboy.sim.places.place_config import straight_corridor
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.truth.events import STANDS_S, ThingLog
from peopleboy.sim.truth.truth import Backgrounds
from peopleboy.sim.world import SimulatedWorld
from peopleboy.sim.world_config import WorldConfig
from tests.helpers.calls.refused import refused

AT = (3.5, 0.8)
ROBOT = RobotConfig(at_m=(1.0, 0.0))
START = Stance((*AT, 0.0), 0.0)
BLOCK = build_thing(ThingConfig(kind="block"), Stance((*AT, 0.0), 0.0), name="box")
ANNA = PersonConfig(name="anna", path=(Waypoint(at_m=(4.0, 0.0), pause_s=0.4), Waypoint(at_m=(4.0, -2.0))))


def box(*actions: Action, hidden: bool = False) -> Mover:
    corner = (0.25, 0.25, 0.5)
    return Mover(
        name="box", start=START, low_m=(-0.25, -0.25, 0.0), high_m=corner, is_hidden_at_start=hidden,
        actions=actions,
    )  # fmt: skip


GLIDE = Action(kind=ActionKind.GLIDE, at_s=0.2, takes_s=0.6, target=Stance((3.5, -0.7, 0.0), 0.5), by="anna")
GO = Action(kind=ActionKind.VANISH, at_s=2.0, target=GLIDE.target)


def hall(*movers: Mover, things: bool = True) -> Place:
    return build_place(straight_corridor(6.0, 5.0), things=BLOCK if things else (), movers=movers)


@pytest.fixture(scope="module")
def world() -> Iterator[SimulatedWorld]:
    with SimulatedWorld(WorldConfig(robot=ROBOT, place=hall(box(GLIDE, GO)), people=(ANNA,))) as world:
        yield world


def test_pixels_belong_to_whom_they_show_and_things_are_told_where_they_are(world: SimulatedWorld) -> None:
    truth = world.truth()
    owners = truth.owners
    (thing,) = truth.things
    mask = owners.mask("box")
    assert 500 < thing.visible_px == np.count_nonzero(mask)
    v, u = np.nonzero(mask)
    assert thing.visible_box == (u.min() - 0.5, v.min() - 0.5, np.ptp(u) + 1, np.ptp(v) + 1)
    assert np.array_equal(owners.mask("anna"), truth.instance == 1)
    names = np.array([*owners.names, ""])[owners.image()]
    assert set(np.unique(names)) >= {"anna", "box", "floor", "wall_east"}
    assert not owners.mask("nobody").any()
    assert (thing.position_m, thing.is_there, thing.is_moving) == ((*AT, 0.0), True, False)


def test_the_background_is_what_a_world_without_people_and_movables_shows(world: SimulatedWorld) -> None:
    with SimulatedWorld(WorldConfig(robot=ROBOT, place=hall(things=False))) as empty:
        bare = empty.truth().depth_m
    assert np.array_equal(world.truth().background_m(), bare)
    assert (world.truth().depth_m <= bare).all()


def test_events_say_from_where_to_where_and_by_whom() -> None:
    log, told, ever = ThingLog(), [], Backgrounds()
    with SimulatedWorld(WorldConfig(robot=ROBOT, place=hall(box(GLIDE, GO)), people=(ANNA,))) as world:
        for _ in range(40):
            truth = world.truth()
            told += log.update(truth)
            ever.update(truth)
            world.step(0.0, 0.0)
    moved, gone = told
    assert (moved.kind, moved.thing, moved.by) == ("thing moved", "box", "anna")
    assert moved.move is not None
    assert moved.move.from_m == (*AT, 0.0)
    assert moved.move.to_m == (3.5, -0.7, 0.0)
    assert moved.move.distance_m == pytest.approx(1.5)
    assert moved.move.turned_deg == pytest.approx(28.65, abs=0.01)
    assert moved.move.to_s == pytest.approx(0.8, abs=0.07)
    assert moved.time_s == pytest.approx(moved.move.to_s + STANDS_S, abs=0.07)
    assert (gone.kind, gone.by, gone.time_s, gone.move) == ("thing vanished", "", 2.0, None)
    assert ever.frames == 40
    assert ever.clean is not None
    assert ever.ever is not None
    # Everything was away from everywhere at some time; the robot sways by less than a millimetre.
    assert np.abs(ever.ever - ever.clean).max() < 0.005


def test_a_background_starts_anew_when_the_camera_moves() -> None:
    found = Backgrounds()
    with SimulatedWorld(WorldConfig(robot=ROBOT, place=hall(), people=(ANNA,))) as world:
        for _ in range(3):
            found.update(world.truth())
        assert found.frames == 3
        for _ in range(8):
            world.step(0.0, 0.8)
        found.update(world.truth())
        assert found.frames == 1
        assert np.array_equal(found.ever, world.truth().depth_m)


def test_what_is_hidden_is_neither_seen_nor_in_anybodys_way() -> None:
    come = replace(GO, kind=ActionKind.APPEAR, at_s=0.1, target=START)
    place = hall(box(come, hidden=True))
    assert len(place.obstacles_at(0.0)) == len(place.obstacles_at(1.0)) - 1 == len(place.obstacles)
    with SimulatedWorld(WorldConfig(robot=ROBOT, place=place)) as world:
        assert world.truth().things[0].visible_px == 0
        for _ in range(3):
            world.step(0.0, 0.0)
        assert world.truth().things[0].visible_px > 500


def test_a_moved_thing_stops_the_sonar_where_it_is_and_the_bullet_renderer_sees_it_there() -> None:
    target = Stance((2.0, 0.0, 0.0), 0.0)
    action = Action(kind=ActionKind.APPEAR, at_s=0.05, target=target)
    config = WorldConfig(robot=ROBOT, place=hall(box(action, hidden=True)))
    sonar = []
    for renderer in ("raycast", "bullet"):
        with SimulatedWorld(replace(config, renderer=renderer)) as world:
            before = world.sense().sonar_m.min()
            world.step(0.0, 0.0)
            sonar.append((before, world.sense().sonar_m.min(), world.truth().things[0].visible_px))
    assert sonar[0][:2] == sonar[1][:2]
    assert sonar[0][1] < 0.65 < sonar[0][0]
    assert sonar[0][2] == pytest.approx(sonar[1][2], rel=0.02)


def test_a_thing_is_not_moved_by_nobody() -> None:
    with (
        refused("'box'", "'ana'"),
        SimulatedWorld(WorldConfig(robot=ROBOT, place=hall(box(replace(GLIDE, by="ana"))))),
    ):
        pass
