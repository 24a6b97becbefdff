import pickle
from typing import get_args

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.sim.people.body.postures import Posture
from peopleboy.sim.people.equipment import RIDDEN, Equipment, bicycle_size
from peopleboy.sim.people.person_config import PersonConfig, Waypoint
from peopleboy.sim.world import SimulatedWorld
from tests.helpers.worlds.person_shapes import surface_points
from tests.helpers.worlds.small_worlds import config, person
from tests.helpers.worlds.walkers import make_person, settle, walk

KINDS = [kind for kind in get_args(Equipment) if kind != "nothing"]
PUSHED = ("walking_frame", "trolley", "pushchair")
WAY = (Waypoint(at_m=(0.0, 0.0)), Waypoint(at_m=(30.0, 0.0), speed_m_s=1.0))


def points_of(person, only):
    """(N, 3) [m] points over the parts with these keys, or whose keys begin so, in the world frame."""
    rows = zip(person.model.part_keys, person.model.parts, person.poses(), strict=True)
    return np.concatenate(
        [surface_points(s) @ pose[:3, :3].T + pose[:3, 3]
         for key, part, pose in rows if key.startswith(only) for s in part.shapes]
    )  # fmt: skip


def underway(kind, **settings):
    return settle(make_person(path=WAY, equipment=kind, **settings), 2.0)


@pytest.mark.parametrize("height_m", [1.1, 1.75, 2.0])
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "box"])
def test_wheels_are_on_the_floor_and_go_with_the_person(kind, height_m):
    rider = underway(kind, height_m=height_m)
    offsets = []
    for _ in walk(rider, 1.0, start=2.0):
        wheels = points_of(rider, f"ann.{kind}/wheels")
        assert wheels[:, 2].min() == pytest.approx(0.0, abs=0.012)
        offsets.append(wheels.mean(axis=0)[:2] - rider.position)
    assert np.ptp(offsets, axis=0).max() < 1e-9


@pytest.mark.parametrize("gait", ["usual", "old"])
@pytest.mark.parametrize("kind", PUSHED)
def test_hands_are_at_the_handles(kind, gait):
    pusher = underway(kind, gait=gait)
    for _ in walk(pusher, 1.2, start=2.0):
        frame = points_of(pusher, f"ann.{kind}/frame")
        for side in ("left", "right"):
            assert np.linalg.norm(frame - pusher.palm(side), axis=1).min() < 0.09


def test_a_box_is_between_the_palms():
    porter = underway("box")
    for _ in walk(porter, 1.2, start=2.0):
        carton = points_of(porter, "ann.box/")
        low, high = carton.min(axis=0), carton.max(axis=0)
        for side in ("left", "right"):
            assert (porter.palm(side) > low - 0.06).all()
            assert (porter.palm(side) < high + 0.06).all()


@pytest.mark.parametrize("height_m", [1.2, 1.75])
def test_feet_turn_the_pedals_of_a_bicycle_with_the_way(height_m):
    cyclist = underway("bicycle", height_m=height_m)
    size = bicycle_size(height_m)
    ankles = {15: [], 16: []}
    for _ in walk(cyclist, 4.0, start=2.0):
        for joint, found in ankles.items():
            found.append(cyclist.joints()[joint] - [*cyclist.position, 0.0])
    left, right = (np.array(found)[:, [0, 2]] for found in ankles.values())
    for path in (left, right):  # a circle of the cranks' length, as the foot keeps its pitch
        radius = np.linalg.norm(path - (path.max(axis=0) + path.min(axis=0)) / 2.0, axis=1)
        np.testing.assert_allclose(radius, size.arm, atol=0.01)
    np.testing.assert_allclose(left + right, (left + right).mean(axis=0) + 0 * left, atol=0.02)


@pytest.mark.parametrize("height_m", [1.1, 1.75])
def test_who_rides_sits_on_the_seat_with_feet_above_the_floor(height_m):
    for kind in RIDDEN:
        rider = underway(kind, height_m=height_m)
        hips = rider.joints()[[11, 12]].mean(axis=0)
        seat = points_of(rider, f"ann.{kind}/{'saddle' if kind == 'bicycle' else 'seat'}")
        nearest = seat[np.linalg.norm(seat[:, :2] - hips[:2], axis=1) < 0.15]
        assert 0.0 < hips[2] - nearest[:, 2].min() < 0.3
        assert rider.joints()[[15, 16], 2].min() > 0.08


@pytest.mark.parametrize("kind", KINDS)
def test_equipment_is_an_object_of_its_own_which_hides_people(kind):
    ann = person("ann", (3.0, 0.6), (3.0, -1.0), equipment=kind)
    ben = person("ben", (3.6, 0.0), sex="female")
    with SimulatedWorld(config(ann, ben)) as world:
        seen = []
        for _ in range(20):
            world.step(0.0, 0.0)
            truth = world.truth()
            seen += [key for each in truth.people for key in each.hidden_by]
            names = list(truth.people[0].part_temperature_c)
            assert not {"wheels", "frame", "carton"} & set(names)
        assert f"ann.{kind}" in seen


def test_a_copied_person_goes_on_with_the_same_poses():
    fast = (WAY[0], Waypoint(at_m=(30.0, 0.0), speed_m_s=2.0))
    for settings in ({"equipment": "bicycle"}, {"gait": "running"}):
        one = settle(make_person(path=fast, **settings), 0.5)
        other = pickle.loads(pickle.dumps(one))
        np.testing.assert_array_equal(one.poses(), other.poses())


def test_without_equipment_a_person_has_no_other_parts():
    assert all(key.startswith("ann/") for key in make_person().model.part_keys)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"equipment": "trolley", "bag": True}, "no hand for a bag"),
        ({"equipment": "box", "arms": "crossed"}, "holds it with both hands"),
        ({"equipment": "bicycle", "gait": "old"}, "does not walk"),
        ({"gait": "running"}, "needs a speed_m_s of at least 1.6"),
    ],
)
def test_what_a_person_cannot_do_is_refused(settings, words):
    with pytest.raises(BadInput, match=words):
        PersonConfig(name="ann", path=WAY, **settings)


def test_a_posture_that_is_impossible_with_equipment_is_refused_where_it_is():
    path = (*WAY, Waypoint(at_m=(31.0, 0.0), pause_s=1.0, posture=Posture.LYING))
    with pytest.raises(BadInput, match=r"path\[2\].posture.*lying"):
        PersonConfig(name="ann", path=path, equipment="trolley")
