import math

import numpy as np
import pytest

from peopleboy.sim.people.body.body_shapes import sole_points
from peopleboy.sim.people.body.postures import Posture
from peopleboy.sim.people.body.skeleton import mirror
from peopleboy.sim.people.motion.gait_styles import GAIT_STYLES
from peopleboy.sim.people.motion.motion_clips import fourier_basis, load_motion_clip
from peopleboy.sim.people.person_config import Waypoint
from tests.helpers.worlds.walkers import make_person, settle, walk

FOOT_PARTS = ("left_foot", "right_foot")


def walker(speed, **settings):
    path = (
        Waypoint(at_m=(0.0, 0.0)),
        Waypoint(at_m=(40.0, 0.0), speed_m_s=speed),
        Waypoint(at_m=(60.0, 0.0), speed_m_s=2.0),
    )
    return make_person(path=path, **settings)


def sole_tracks(person, seconds, start, dt=1 / 240):
    """(T, 6, 3) [m] heel, ball and toe of both feet in the world."""
    soles = sole_points(person.config.height_m)
    index = [[part.name for part in person.model.parts].index(name) for name in FOOT_PARTS]
    track = []
    for _ in walk(person, seconds, dt, start=start):
        feet = person.poses()[index]
        track.append(np.concatenate([soles @ f[:3, :3].T + f[:3, 3] for f in feet]))
    return np.array(track)


def contacts(height):
    """Ranges of steps in which a point stays within 4 mm of the floor, those that are cut off left out."""
    edges = np.flatnonzero(np.diff((height < 0.004).astype(int)))
    if len(edges) and height[0] < 0.004:
        edges = edges[1:]
    return [(a + 1, b + 1) for a, b in zip(edges[::2], edges[1::2], strict=False)]


@pytest.mark.slow
@pytest.mark.parametrize("speed", [0.5, 0.9, 1.2, 1.6])
@pytest.mark.parametrize("height", [1.55, 1.9])
def test_a_foot_on_the_floor_stands_still(speed, height):
    track = sole_tracks(settle(walker(speed, height_m=height), 3.0), 4.0, start=3.0)
    rolls = [(point, span) for point in range(6) for span in contacts(track[:, point, 2])]
    flat = [(p, s) for p, s in rolls if p % 3 == 1]
    assert len(flat) >= 4
    for point, (a, b) in flat:
        slip = np.ptp(track[a:b, point, :2], axis=0)
        assert np.hypot(*slip) < 0.02, (point, slip)


@pytest.mark.parametrize("speed", [0.5, 0.9, 1.2, 1.6])
def test_soles_neither_sink_nor_hover(speed):
    track = sole_tracks(settle(walker(speed), 3.0), 3.0, start=3.0)
    lowest = track[..., 2].min(axis=1)
    assert lowest.min() > -0.01
    assert lowest.max() < 0.02
    assert track[:, 0, 2].max() > 0.1


def test_soles_stay_on_the_floor_while_starting_stopping_turning_and_changing_posture():
    path = (
        Waypoint(at_m=(0.0, 0.0), pause_s=2.0, posture=Posture.SITTING),
        Waypoint(at_m=(2.0, 0.0), pause_s=1.5, posture=Posture.BENDING, face=(2.0, 5.0)),
        Waypoint(at_m=(2.0, 2.0)),
    )
    track = sole_tracks(make_person(path=path), 12.0, start=0.0, dt=1 / 60)
    lowest = track[..., 2].min(axis=1)
    assert lowest.min() > -0.01
    assert lowest.max() < 0.02


@pytest.mark.parametrize("speed", [0.5, 1.2, 1.6])
def test_the_head_bobs_a_little_and_stays_near_the_stature(speed):
    person = settle(walker(speed, height_m=1.75), 3.0)
    heights = np.array([person.joints()[0, 2] for _ in walk(person, 2.0, start=3.0)])
    standing = make_person(height_m=1.75).joints()[0, 2]
    assert 0.003 < np.ptp(heights) < 0.06
    assert 0.0 < standing - heights.mean() < 0.06


def test_poses_are_rigid_and_change_smoothly():
    path = (
        Waypoint(at_m=(0.0, 0.0), pause_s=1.0, posture=Posture.ARMS_RAISED),
        Waypoint(at_m=(2.0, 0.0)),
        Waypoint(at_m=(2.0, 2.0), pause_s=2.0, posture=Posture.SITTING, face=(0.0, 0.0)),
        Waypoint(at_m=(0.0, 2.0)),
    )
    person = make_person(path=path, bag=True)
    before, fastest = None, 0.0
    for _ in walk(person, 14.0):
        poses = person.poses()
        rotation = poses[:, :3, :3]
        np.testing.assert_allclose(
            rotation @ rotation.transpose(0, 2, 1), np.tile(np.eye(3), (len(poses), 1, 1)), atol=1e-9
        )
        assert (np.linalg.det(rotation) > 0).all()
        np.testing.assert_array_equal(poses[:, 3], np.tile([0.0, 0.0, 0.0, 1.0], (len(poses), 1)))
        if before is not None:
            fastest = max(fastest, np.linalg.norm(poses[:, :3, 3] - before[:, :3, 3], axis=1).max() * 60)
        before = poses
    assert fastest < 8.0


def test_the_phase_follows_the_distance_and_steps_grow_with_speed():
    strides = {}
    for speed in (0.6, 1.4):
        person = settle(walker(speed), 4.0)
        heel = sole_tracks(person, 6.0, start=4.0, dt=1 / 60)[:, 0]
        spans = contacts(heel[:, 2])
        strikes = [heel[a, 0] for a, _ in spans]
        steps = np.diff(strikes)
        strides[speed] = np.median(steps[steps > 0.3])
    assert strides[1.4] / strides[0.6] == pytest.approx(math.sqrt(1.4 / 0.6), rel=0.05)
    assert 1.2 < strides[1.4] < 1.6


def test_arms_swing_against_the_legs_and_less_with_a_bag():
    def swing(person):
        settle(person, 3.0)
        rows = []
        for _ in walk(person, 2.5, start=3.0):
            joints = person.joints() - [*person.position, 0.0]
            rows.append([joints[10, 0], joints[15, 0]])  # right wrist, left ankle
        return np.array(rows)

    free, burdened = swing(walker(1.2)), swing(walker(1.2, bag=True))
    assert np.corrcoef(free.T)[0, 1] > 0.8
    assert np.ptp(burdened[:, 0]) < 0.5 * np.ptp(free[:, 0])


def test_the_clip_is_symmetric_after_half_a_cycle():
    clip = load_motion_clip("walking")
    phases = np.linspace(0, 1, 17)
    left = np.tensordot(fourier_basis(phases), clip.rotations, axes=1)
    right = mirror(np.tensordot(fourier_basis(phases + 0.5), clip.rotations, axes=1))
    np.testing.assert_allclose(left, right, atol=0.02)


def test_a_standing_person_sways_without_moving_its_feet():
    person = make_person()
    track = sole_tracks(person, 6.0, start=0.0, dt=1 / 30)
    assert np.ptp(track[..., :2], axis=0).max() < 0.012
    heads = np.array([person.joints()[0, :2] for _ in walk(person, 6.0, dt=1 / 30, start=6.0)])
    assert 0.002 < np.ptp(heads, axis=0).max() < 0.04


GAITS = [(gait, {"running": 2.4, "shuffling": 0.5, "old": 0.8}.get(gait, 1.0)) for gait in GAIT_STYLES]


@pytest.mark.parametrize(("gait", "speed"), GAITS)
def test_the_sole_rests_in_every_gait(gait, speed):
    track = sole_tracks(settle(walker(speed, gait=gait), 3.0), 3.0, start=3.0)
    rests = [(point, span) for point in (1, 4) for span in contacts(track[:, point, 2])]
    assert len(rests) >= 4
    for point, (a, b) in rests:
        assert np.hypot(*np.ptp(track[a:b, point, :2], axis=0)) < 0.01
    assert track[..., 2].min() > -0.002


def test_only_who_runs_leaves_the_floor_and_only_when_fast():
    def flight(**settings):
        track = sole_tracks(settle(walker(**settings), 3.0), 2.0, start=3.0)
        return track[..., 2].min(axis=1)

    assert flight(speed=2.4).max() < 1e-9
    assert flight(speed=1.0, gait="running").max() < 1e-9
    lowest = flight(speed=2.4, gait="running")
    assert 0.04 < lowest.max() < 0.1
    assert 0.2 < np.mean(lowest > 0.005) < 0.5


def test_gaits_differ_as_they_say():
    def stride_and_trunk(gait):
        person = settle(walker(0.8, gait=gait), 3.0)
        phases, leans, widths = [], [], []
        for _ in walk(person, 3.0, start=3.0):
            joints = person.joints()
            shoulders, hips = joints[[5, 6]].mean(axis=0), joints[[11, 12]].mean(axis=0)
            leans.append(shoulders[0] - hips[0])
            phases.append(float(person.stance["phase"][0]))
            widths.append(joints[15, 1] - joints[16, 1])
        cycles = np.unwrap(np.array(phases) * 2.0 * np.pi) / (2.0 * np.pi)
        return 2.4 / (cycles[-1] - cycles[0]), np.mean(leans), np.mean(widths)

    usual, old, heavy, shuffling = map(stride_and_trunk, ("usual", "old", "heavy", "shuffling"))
    assert shuffling[0] < 0.6 * usual[0] < old[0] < 0.85 * usual[0]
    assert shuffling[1] > old[1] > usual[1] + 0.05
    assert heavy[2] > usual[2] + 0.04
