import itertools

import numpy as np
import pytest

from peopleboy.sim.people.body import anthropometry as table
from peopleboy.sim.people.body.anthropometry import MEAN_GIRTHS, measure
from peopleboy.sim.people.body.body_shapes import TORSO_PARTS
from peopleboy.sim.people.body.clothes import Clothes
from peopleboy.sim.people.body.postures import Posture
from peopleboy.sim.people.body.skeleton import JOINT_NAMES, PARENTS, joint_offsets
from peopleboy.sim.people.body_model import ARM_PARTS, PART_CLASSES
from peopleboy.sim.people.person_config import Waypoint
from tests.helpers.worlds.person_shapes import person_depth, person_points
from tests.helpers.worlds.walkers import make_person, settle, walk

BARE = Clothes(top="t_shirt", bottom="leggings")
BODIES = list(itertools.product(("female", "male"), ("slim", "average", "stout")))
PARENT_PART = {bone: parent for bone, parent in PARENTS.items() if parent is not None}


def in_posture(posture, **settings):
    return settle(make_person(path=(Waypoint(at_m=(0.0, 0.0), posture=posture),), **settings), 0.5)


@pytest.mark.parametrize("height", [1.5, 1.63, 1.78, 2.0])
@pytest.mark.parametrize("sex", ["female", "male"])
def test_an_upright_person_is_as_tall_as_configured(height, sex):
    points = person_points(settle(make_person(height_m=height, sex=sex), 0.1))
    assert points[:, 2].max() == pytest.approx(height, abs=0.01)
    assert points[:, 2].min() == pytest.approx(0.0, abs=0.005)


def test_segments_have_the_tables_lengths():
    joints = dict(zip(JOINT_NAMES, make_person(height_m=1.8).joints() / 1.8, strict=True))

    def length(a, b):
        return np.linalg.norm(joints[a] - joints[b])

    for side in ("left", "right"):
        assert length(f"{side}_elbow", f"{side}_wrist") == pytest.approx(table.FOREARM_LENGTH, abs=1e-6)
        assert length(f"{side}_hip", f"{side}_knee") == pytest.approx(0.245, abs=1e-6)
        assert length(f"{side}_knee", f"{side}_ankle") == pytest.approx(0.246, abs=1e-6)
        assert joints[f"{side}_knee"][2] == pytest.approx(table.KNEE_HEIGHT, abs=0.004)
        assert joints[f"{side}_shoulder"][2] == pytest.approx(table.SHOULDER_HEIGHT, abs=0.015)
        assert joints[f"{side}_eye"][2] == pytest.approx(table.EYE_HEIGHT, abs=0.004)


@pytest.mark.parametrize("sex", ["female", "male"])
def test_breadths_and_depths_are_the_surveys(sex):
    person = settle(make_person(height_m=1.7, sex=sex, clothes=BARE), 0.1)
    girths = MEAN_GIRTHS[sex]

    def span(axis, *parts, above=0.0):
        points = person_points(person, parts) / 1.7
        return np.ptp(points[points[:, 2] > above, axis])

    assert span(1, "left_upper_arm", "right_upper_arm", above=0.76) == pytest.approx(
        girths.bideltoid_breadth, abs=0.012
    )
    assert span(1, "pelvis", "left_thigh", "right_thigh") == pytest.approx(girths.hip_breadth, abs=0.015)
    assert span(0, "pelvis") == pytest.approx(girths.buttock_depth, abs=0.015)
    assert span(1, "hair") == pytest.approx(girths.head_breadth, abs=0.003)
    assert span(0, "head", "hair") == pytest.approx(girths.head_length, abs=0.015)


def test_women_have_broader_hips_and_narrower_shoulders_than_men_of_their_height():
    woman, man = measure(1.7, "female", "average").girths, measure(1.7, "male", "average").girths
    assert woman.hip_breadth > man.hip_breadth
    assert woman.bideltoid_breadth < man.bideltoid_breadth


@pytest.mark.parametrize("sex", ["female", "male"])
def test_stout_people_are_broader_and_deeper_than_slim_ones(sex):
    slim, average, stout = (
        np.ptp(person_points(make_person(sex=sex, build=b), ["abdomen"])[:, :2], axis=0)
        for b in ("slim", "average", "stout")
    )
    assert (slim < average).all()
    assert (average < stout).all()


def bone_gap(person, bone, parent):
    """[m] how far the surfaces of two neighbouring parts are from meeting; negative where they overlap."""
    return -person_depth(person, person_points(person, [bone]), [parent]).max()


@pytest.mark.parametrize("posture", list(Posture))
@pytest.mark.parametrize(("sex", "build"), BODIES)
def test_neighbouring_parts_overlap_in_every_posture(posture, sex, build):
    person = in_posture(posture, sex=sex, build=build, clothes=BARE)
    for bone, parent in PARENT_PART.items():
        assert bone_gap(person, bone, parent) < -0.004, (bone, parent)


def test_neighbouring_parts_overlap_while_walking():
    person = make_person(path=(Waypoint(at_m=(0.0, 0.0)), Waypoint(at_m=(9.0, 0.0), speed_m_s=1.6)))
    for k, _ in enumerate(walk(person, 4.0, dt=1 / 15)):
        if k % 4 == 0:
            for bone, parent in PARENT_PART.items():
                assert bone_gap(person, bone, parent) < -0.004, (bone, parent)


@pytest.mark.parametrize("posture", list(Posture))
@pytest.mark.parametrize(("sex", "build"), BODIES)
def test_every_joint_lies_inside_the_persons_shapes(posture, sex, build):
    person = in_posture(posture, sex=sex, build=build, height_m=1.66, clothes=BARE)
    assert (person_depth(person, person.joints()) > 0.003).all()


def test_face_joints_lie_close_to_the_surface():
    person = make_person()
    assert (person_depth(person, person.joints()[:5]) < 0.02).all()


def test_left_joints_are_on_the_left():
    joints = dict(zip(JOINT_NAMES, make_person().joints(), strict=True))
    for name, point in joints.items():
        if name != "nose":
            assert (point[1] > 0) == name.startswith("left"), name
    assert joints["nose"][0] > joints["left_eye"][0] > joints["left_ear"][0]


def test_parts_are_named_and_classed():
    names = [part.name for part in make_person(bag=True, arms="telephone").model.parts]
    assert len(set(names)) == len(names)
    assert set(names) == set(PART_CLASSES)
    assert sorted(PART_CLASSES.values()) == list(range(1, len(names) + 1))
    assert set(ARM_PARTS) | set(TORSO_PARTS) <= set(names)
    assert not {"bag", "phone"} & {part.name for part in make_person().model.parts}


def test_from_behind_the_head_is_mostly_hair():
    person = make_person()
    hair, face = person_points(person, ["hair"]), person_points(person, ["head"])
    assert hair[:, 0].min() < face[:, 0].min() - 0.02
    assert face[:, 0].max() > hair[:, 0].max() + 0.005


def test_a_seated_person_is_lower_and_a_bent_one_reaches_forward():
    standing, sitting, bending = (
        person_points(in_posture(p)) for p in (Posture.STANDING, Posture.SITTING, Posture.BENDING)
    )
    assert 0.70 < sitting[:, 2].max() / standing[:, 2].max() < 0.78
    assert sitting[:, 2].min() == pytest.approx(0.0, abs=0.005)
    assert bending[:, 0].max() > standing[:, 0].max() + 0.15
    assert bending[:, 2].max() < 1.3


def test_a_crouching_person_stays_above_the_feet_and_is_as_low_as_a_seated_one():
    crouching = in_posture(Posture.CROUCHING)
    points, feet = person_points(crouching), person_points(crouching, ["left_foot", "right_foot"])
    assert points[:, 2].min() == pytest.approx(0.0, abs=0.005)
    assert points[:, 2].max() / person_points(in_posture(Posture.STANDING))[:, 2].max() < 0.72
    trunk = person_points(crouching, TORSO_PARTS)[:, 0].mean()
    assert feet[:, 0].min() < trunk < feet[:, 0].max()


@pytest.mark.parametrize(("sex", "build"), BODIES)
def test_a_kneeling_person_rests_on_one_knee_and_the_other_foot(sex, build):
    person = in_posture(Posture.KNEELING, sex=sex, build=build, height_m=1.7, clothes=BARE)
    knee, foot = (person_points(person, [part])[:, 2].min() for part in ("right_shin", "left_foot"))
    assert foot == pytest.approx(0.0, abs=0.02)
    assert knee == pytest.approx(0.0, abs=0.05)
    assert person_points(person)[:, 2].min() > -0.04
    assert 0.65 < person_points(person)[:, 2].max() / 1.7 < 0.8
    joints = dict(zip(JOINT_NAMES, person.joints(), strict=True))
    assert joints["left_knee"][2] > joints["right_knee"][2] + 0.3
    assert joints["right_ankle"][0] < joints["right_knee"][0] - 0.3


@pytest.mark.parametrize("posture", [Posture.LYING, Posture.FALLEN])
@pytest.mark.parametrize(("sex", "build"), BODIES)
def test_a_person_on_the_floor_rests_on_it_at_full_length(posture, sex, build):
    person = in_posture(posture, sex=sex, build=build, height_m=1.7, clothes=BARE)
    points, trunk = person_points(person), person_points(person, [*TORSO_PARTS, "head"])
    assert trunk[:, 2].min() == pytest.approx(0.0, abs=0.02)
    assert points[:, 2].min() > -0.06
    assert points[:, 2].max() < 0.45
    assert 1.6 < np.ptp(points[:, 0]) < 2.2


def test_lying_faces_up_and_a_fall_ends_face_down():
    for posture, sign in ((Posture.LYING, 1.0), (Posture.FALLEN, -1.0)):
        joints = dict(zip(JOINT_NAMES, in_posture(posture).joints(), strict=True))
        hips = (joints["left_hip"] + joints["right_hip"]) / 2
        assert joints["nose"][0] * sign < hips[0] * sign
        assert (joints["nose"][2] > joints["left_ear"][2]) == (posture is Posture.LYING)


def test_a_fall_is_fast_and_getting_up_is_slow():
    path = (
        Waypoint(at_m=(0.0, 0.0)),
        Waypoint(at_m=(1.0, 0.0), pause_s=3.0, posture=Posture.FALLEN),
        Waypoint(at_m=(3.0, 0.0)),
    )
    person = make_person(path=path)
    heads = np.array([(person.joints()[0, 2], *person.velocity) for _ in walk(person, 9.0, dt=1 / 60)])
    tall = heads[:, 0].max()
    down = np.flatnonzero(heads[:, 0] < 0.3)
    before = np.flatnonzero(heads[: down[0], 0] > 0.95 * tall)[-1]
    after = down[-1] + np.flatnonzero(heads[down[-1] :, 0] > 0.95 * tall)[0]
    assert 0.2 < (down[0] - before) / 60 < 0.6
    assert 0.8 < (after - down[-1]) / 60 < 2.1
    moving = np.hypot(heads[:, 1], heads[:, 2]) > 0.0
    assert not moving[down[0] : after - 10].any()


def test_raised_arms_reach_above_the_head_and_crossed_arms_lie_on_the_chest():
    raised, crossed = in_posture(Posture.ARMS_RAISED), in_posture(Posture.ARMS_CROSSED)
    hands = ["left_hand", "right_hand"]
    assert person_points(raised, hands)[:, 2].min() > 1.75
    wrists = crossed.joints()[9:11]
    assert (np.abs(wrists[:, 1]) < 0.12).all()
    assert (wrists[:, 0] > 0.1).all()


def test_offsets_scale_with_stature():
    short, tall = (joint_offsets(measure(h, "male", "average")) for h in (1.5, 2.0))
    np.testing.assert_allclose(short / 1.5, tall / 2.0)
