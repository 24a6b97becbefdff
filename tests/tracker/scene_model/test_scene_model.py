"""What stands, what was moved, and by whom."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.tracker.frame import DEPTH, Frame, Odometry
from peopleboy.tracker.scene_model.scene import Change, Happening, ObjectState, VistaScene
from peopleboy.tracker.scene_model.scene_config import PeopleMaskConfig, SceneConfig
from peopleboy.tracker.scene_model.scene_model import SceneModel
from tests.helpers.some_of import some_of
from tests.helpers.still_room import WALL_M, Screen, room_frame, true_depth

BOX = Screen(3.5, 0.2, -0.2, 0.0, 0.5)
AWAY = Screen(3.5, -0.7, -1.1, 0.0, 0.5)
PERSON = Screen(4.0, 0.25, -0.25, 0.0, 1.7, is_warm=True, rgb=(40, 40, 200))


def at(person: Screen, aside_m: float) -> Screen:
    return replace(person, left_m=aside_m + 0.25, right_m=aside_m - 0.25)


def visit(before: Sequence[Screen], after: Sequence[Screen]) -> list[list[Screen]]:
    """Somebody comes from the left, stays for 2 s while things change, and goes again."""
    ways = [*np.linspace(2.2, 0.6, 20), *[0.6] * 30, *np.linspace(0.6, 2.2, 20)]
    people = [[at(PERSON, way)] for way in ways]
    moving = [[*(before if k < 35 else after), *one] for k, one in enumerate(people)]
    return [[*before]] * 20 + moving + [[*after]] * 45


def watch(model: SceneModel, film: Iterable[Sequence[Screen]], *, has_heat: bool = True) -> list[VistaScene]:
    rng = np.random.default_rng(0)
    return [
        model.update(room_frame(k, screens, rng=rng, has_heat=has_heat)) for k, screens in enumerate(film)
    ]


def told(scenes: Sequence[VistaScene]) -> list[Happening]:
    return [one for scene in scenes for one in scene.happenings]


@pytest.mark.slow
@pytest.mark.parametrize("has_heat", some_of([True, False], 2))
def test_what_somebody_puts_down_is_told_with_time_place_and_person(has_heat: bool) -> None:
    scenes = watch(SceneModel(SceneConfig()), visit([], [BOX]), has_heat=has_heat)
    (one,) = told(scenes)
    assert (one.change, one.from_m, one.person) == (Change.APPEARED, None, 1)
    assert one.time_s == pytest.approx(55 / 15.0, abs=0.5)
    assert one.to_m == pytest.approx((3.5, 0.0, 0.25), abs=0.08)
    assert [thing.state for thing in scenes[-1].objects] == [ObjectState.STANDS]


@pytest.mark.slow
def test_what_stood_from_the_start_and_is_carried_away_was_no_background() -> None:
    scenes = watch(SceneModel(SceneConfig()), visit([BOX], []))
    (one,) = told(scenes)
    assert (one.change, one.to_m, one.person) == (Change.VANISHED, None, 1)
    assert one.from_m == pytest.approx((3.5, 0.0, 0.25), abs=0.08)
    assert float(np.median(scenes[-1].background_m[true_depth([BOX])[1] > 0])) > 3.9


@pytest.mark.slow
def test_what_vanishes_here_and_appears_there_was_moved() -> None:
    model = SceneModel(SceneConfig())
    happenings = told(watch(model, visit([BOX], [AWAY])))
    moved = [one for one in happenings if one.change is Change.MOVED]
    assert len(moved) == 1
    assert moved[0].way_m == pytest.approx(0.9, abs=0.1)
    assert moved[0].person == 1


@pytest.mark.thorough
def test_things_that_look_different_are_not_one_that_was_moved() -> None:
    green = replace(AWAY, rgb=(40, 200, 40))
    happenings = told(watch(SceneModel(SceneConfig()), visit([BOX], [green])))
    assert {one.change for one in happenings} == {Change.VANISHED, Change.APPEARED}


@pytest.mark.thorough
def test_what_swings_to_another_place_bit_by_bit_is_told_to_have_moved() -> None:
    swing = [Screen(far, 1.0, 0.55 - 1.05 / far, 0.0, 1.0) for far in np.linspace(3.5, 4.6, 25)]
    film = [[]] * 20 + [[swing[0]]] * 40 + [[one] for one in swing] + [[swing[-1]]] * 60
    happenings = told(watch(SceneModel(SceneConfig()), film))
    assert happenings[0].change is Change.APPEARED
    moved = [one for one in happenings if one.change is Change.MOVED]
    assert len(moved) == 1
    assert moved[0].to_m is not None
    assert moved[0].to_m[0] == pytest.approx(4.6, abs=0.1)


@pytest.mark.slow
def test_what_somebody_holds_still_and_takes_along_was_never_put_down() -> None:
    near, held = at(PERSON, 0.6), replace(BOX, ahead_m=4.0, foot_m=0.9, top_m=1.3)
    before = replace(PERSON, ahead_m=3.0, left_m=0.3, right_m=-0.3)
    come = [[at(PERSON, way)] for way in np.linspace(2.2, 0.6, 20)]
    film = [[]] * 20 + come + [[near, held]] * 30 + [[before]] * 60 + [[]] * 60
    assert told(watch(SceneModel(SceneConfig()), film)) == []


@pytest.mark.slow
def test_the_static_scene_has_neither_people_nor_things() -> None:
    scene = watch(SceneModel(SceneConfig()), visit([], [BOX]))[-1]
    empty, _ = true_depth([])
    known = scene.background_m > 0.0
    assert known.mean() > 0.98
    assert float(np.abs(scene.background_m - empty)[known].mean()) < 0.004


@pytest.mark.slow
def test_masks_of_people_and_things_are_where_they_are() -> None:
    film = visit([], [BOX])
    model = SceneModel(SceneConfig())
    scenes = watch(model, film)
    for k in (45, 100):
        _, owner = true_depth(film[k])
        person = np.isin(owner, [n for n, one in enumerate(film[k], 1) if one.is_warm])
        assert ((scenes[k].people > 0) != person).mean() < 0.01
    _, owner = true_depth(film[-1])
    assert ((scenes[-1].things > 0) != (owner > 0)).mean() < 0.01


@pytest.mark.slow
def test_somebody_who_stands_still_is_no_thing_where_no_thermal_camera_sees() -> None:
    film = [[], *[[at(PERSON, way)] for way in np.linspace(2.2, 0.0, 40)], *[[at(PERSON, 0.0)]] * 120]
    config = SceneConfig(people=PeopleMaskConfig(has_heat=False))
    scenes = watch(SceneModel(config), [[]] * 20 + film)
    assert told(scenes) == []
    assert (scenes[-1].people > 0).sum() > 0.9 * (true_depth(film[-1])[1] > 0).sum()


def test_something_warm_on_a_wall_is_background() -> None:
    radiator = Screen(4.9, 1.2, 0.2, 0.1, 0.7, is_warm=True)
    scenes = watch(SceneModel(SceneConfig()), [[radiator]] * 30)
    assert not scenes[-1].people.any()
    assert (scenes[-1].background_m > 0.0).mean() > 0.97


def test_a_robot_that_moves_learns_nothing_and_begins_anew_where_it_stops() -> None:
    model = SceneModel(SceneConfig())
    watch(model, [[]] * 20)
    moving = [model.update(room_frame(20 + k, [], odometry=Odometry(advance_m=0.05))) for k in range(4)]
    assert all(scene.is_frozen for scene in moving)
    still = [model.update(room_frame(24 + k, [])) for k in range(20)]
    assert (still[-1].vista, still[-1].is_frozen) == (1, False)
    assert model.pose.x == pytest.approx(0.2)


def broken(frame: Frame, **images: object) -> Frame:
    kept = {name: image for name, image in {**frame.images, **images}.items() if image is not None}
    return replace(frame, images=kept)  # type: ignore[arg-type]


def test_frames_that_cannot_be_understood_are_refused_in_a_line() -> None:
    first = room_frame(0, [])
    with pytest.raises(BadInput, match="no image of camera 'depth'"):
        SceneModel(SceneConfig()).update(broken(first, depth=None))
    with pytest.raises(BadInput, match="needs a calibrated planar camera"):
        SceneModel(SceneConfig()).update(replace(first, calibrations={}))
    model = SceneModel(SceneConfig())
    model.update(first)
    with pytest.raises(BadInput, match="as the ones before"):
        model.update(broken(room_frame(1, []), depth=np.zeros((60, 80), np.uint16)))
    with pytest.raises(BadInput, match="needs odometry"):
        model.update(room_frame(1, [], odometry=None))
    with pytest.raises(BadInput, match="must have one size"):
        model.update(broken(room_frame(1, []), depth_colour=np.zeros((60, 80, 3), np.uint8)))


def test_nothing_is_known_where_nothing_is_read() -> None:
    model = SceneModel(SceneConfig())
    for k in range(20):
        frame = room_frame(k, [])
        holed = frame.depth(DEPTH).copy()
        holed[:, :20] = 0
        scene = model.update(broken(frame, depth=holed))
    assert not scene.background_m[:, :20].any()
    assert scene.background_m[:40, 21:].max() == pytest.approx(WALL_M, abs=1e-3)
