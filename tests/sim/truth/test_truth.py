import math
from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
import pytest

from peopleboy.sim.geometry.panorama import Panorama
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.people.body_model import PART_CLASSES
from peopleboy.sim.physics.bullet import Bullet
from peopleboy.sim.truth.truth import BORDER, PersonTruth, Truth, is_counted
from peopleboy.sim.world import SimulatedWorld
from tests.helpers.worlds.small_worlds import SMALL, box_thing, config, hall, person, pillar, robot

CAMERA = Pinhole()
# The same camera, with one more image beyond each border.
WIDE = Pinhole(
    width=960, height=720, vertical_fov_rad=2.0 * math.atan(3.0 * math.tan(CAMERA.vertical_fov_rad / 2.0))
)
# Where a wall 0.4 m wide hides part of somebody, and a table his legs.
THINGS = (pillar(4.0, 0.85, 0.4), box_thing("table", (0.8, 0.8, 0.75), (4.0, -1.2, 0.375)))
PEOPLE = (
    person("behind_pillar", (6.0, 1.0), (6.4, 1.1), height_m=1.9),
    person("behind_table", (5.5, -1.5), (5.9, -1.6), sex="female", bag=True),
    person("in_front", (4.5, -0.2), (4.8, -0.25)),
    person("behind_person", (7.0, -0.75), (7.3, -0.8), build="stout"),
    person("at_border", (4.0, 1.5), (4.4, 1.75)),
    person("behind_robot", (0.0, 0.5), (-0.2, 0.5)),
)


@dataclass(frozen=True)
class Scene:
    world: SimulatedWorld
    truth: Truth
    whole: dict[str, np.ndarray]
    alone: dict[str, np.ndarray]

    def __getitem__(self, name: str) -> PersonTruth:
        return next(person for person in self.truth.people if person.name == name)


def draw_alone(world: SimulatedWorld, k: int, pose: np.ndarray) -> np.ndarray:
    """(3 H, 3 W) where TinyRenderer draws a person in a PyBullet world of its own, image in the middle."""
    person = world.crowd.people[k]
    with Bullet() as bullet:
        for part, part_pose in zip(person.model.parts, person.poses(), strict=True):
            bullet.add_part(part.name, part.shapes)
            angle = cv2.Rodrigues(part_pose[:3, :3])[0].ravel()
            half = np.linalg.norm(angle) / 2.0
            axis = angle / max(2.0 * half, 1e-12) * np.sin(half)
            bullet.set_pose(part.name, tuple(part_pose[:3, 3]), (*axis, np.cos(half)))
        mask, _ = bullet.camera_image(WIDE, pose)
    return mask >= 0


@pytest.fixture(scope="module", params=[0, 9])
def scene(request: pytest.FixtureRequest) -> Iterator[Scene]:
    """The same crowd after a number of control steps."""
    with SimulatedWorld(config(*PEOPLE, place=hall(*THINGS), robot=robot(camera=CAMERA))) as world:
        for _ in range(request.param):
            world.step(0.1, 0.05)
        truth = world.truth()
        whole = {
            person.name: draw_alone(world, k, truth.world_from_camera)
            for k, person in enumerate(truth.people)
        }
        alone = {name: mask[240:480, 320:640] for name, mask in whole.items()}
        yield Scene(world, truth, whole, alone)


@pytest.fixture(scope="module")
def empty() -> Iterator[SimulatedWorld]:
    with SimulatedWorld(config()) as world:
        yield world


@pytest.mark.slow
def test_visible_fraction_agrees_with_drawing_each_person_alone(scene: Scene) -> None:
    for somebody in scene.truth.people:
        drawn = scene.alone[somebody.name]
        seen = np.count_nonzero(scene.truth.instance == somebody.id)
        assert seen == somebody.visible_px
        inside = round(somebody.whole_px * somebody.inside_fraction)
        # TinyRenderer's round shapes are polyhedra, a little smaller than the true ones.
        assert inside * 0.95 <= np.count_nonzero(drawn) <= inside * 1.01
        assert somebody.whole_px * 0.95 <= scene.whole[somebody.name].sum() <= somebody.whole_px * 1.01
        if inside:
            expected = np.count_nonzero(drawn & (scene.truth.instance == somebody.id))
            assert somebody.visible_fraction == pytest.approx(
                expected / scene.whole[somebody.name].sum(), abs=0.02
            )


def test_what_is_seen_and_what_is_hidden_sum_to_the_whole(scene: Scene) -> None:
    for somebody in scene.truth.people:
        if somebody.whole_px:
            shares = [somebody.visible_fraction, *somebody.hidden_by.values()]
            assert sum(shares) == pytest.approx(1.0)
            assert min(shares) >= 0.0
            assert somebody.name not in somebody.hidden_by


@pytest.mark.parametrize(
    ("name", "occluder"),
    [("behind_pillar", "pillar"), ("behind_table", "table"), ("behind_person", "in_front")],
)
def test_the_occluder_is_named(scene: Scene, name: str, occluder: str) -> None:
    assert scene[name].occluder == occluder
    assert set(scene[name].hidden_by) == {occluder}
    assert 0.1 < scene[name].visible_fraction < 0.95
    assert scene[name].occluded_fraction == pytest.approx(scene[name].hidden_by[occluder])


def test_whom_nothing_hides_is_whole(scene: Scene) -> None:
    assert scene["in_front"].visible_fraction == 1.0
    assert scene["in_front"].hidden_by == {}
    assert scene["in_front"].occluder is None


def test_what_the_image_border_cuts_off_is_hidden_by_the_border(scene: Scene) -> None:
    cut = scene["at_border"]
    assert set(cut.hidden_by) == {BORDER}
    assert 0.1 < cut.hidden_by[BORDER] < 0.9
    assert cut.whole_box[0] < -0.5
    assert cut.visible_box[0] == -0.5
    assert cut.occluded_fraction == pytest.approx(0.0, abs=1e-9)


def test_who_is_behind_the_camera_has_no_image_but_a_place(scene: Scene) -> None:
    hidden = scene["behind_robot"]
    assert hidden.box is hidden.whole_box is hidden.visible_box is None
    assert (hidden.whole_px, hidden.visible_px, hidden.visible_fraction) == (0, 0, 0.0)
    assert not hidden.is_in_image
    assert np.isnan(hidden.joints_px).all()
    assert not hidden.joint_is_visible.any()
    assert hidden.distance_m > 1.0


def test_joints_lie_on_the_silhouette(scene: Scene) -> None:
    for somebody in scene.truth.people:
        near = cv2.dilate(scene.alone[somebody.name].astype(np.uint8), np.ones((3, 3)))
        pixels = np.nan_to_num(somebody.joints_px, nan=-9.0).round().astype(int)
        for u, v in pixels[np.all((pixels >= 0) & (pixels < [CAMERA.width, CAMERA.height]), axis=1)]:
            assert near[v, u]


def test_visible_joints_are_those_at_which_the_person_is_seen(scene: Scene) -> None:
    assert scene["in_front"].joint_is_visible.all()
    legs = scene["behind_table"].joint_is_visible[13:]
    assert scene["behind_table"].joint_is_visible[:5].all()
    assert not legs.all()
    assert not scene["behind_person"].joint_is_visible.all()


def test_boxes_lie_in_each_other(scene: Scene) -> None:
    for somebody in scene.truth.people:
        if somebody.whole_box is None:
            continue
        left, top, width, height = somebody.whole_box
        body_left, body_top, body_width, body_height = somebody.box
        assert left - 1e-6 <= body_left
        assert body_left + body_width <= left + width + 1e-6
        assert (body_top, body_height) == pytest.approx((top, height))
        assert body_width < 0.6 * body_height
        if somebody.visible_box is not None:
            # A pixel counts when its centre is covered, so its far edge may stick out by half a pixel.
            seen_left, seen_top, seen_width, seen_height = somebody.visible_box
            assert seen_left >= left - 0.51
            assert seen_top >= top - 0.51
            assert seen_left + seen_width <= left + width + 0.51
            assert seen_top + seen_height <= top + height + 0.51


def test_the_whole_box_is_that_of_the_person_drawn_alone(scene: Scene) -> None:
    for name in ("behind_pillar", "behind_table", "in_front", "behind_person"):
        rows, columns = np.nonzero(scene.alone[name])
        left, top, width, height = scene[name].whole_box
        drawn = [columns.min(), rows.min(), columns.max(), rows.max()]
        assert drawn == pytest.approx([left, top, left + width, top + height], abs=2.5)


def test_masks_and_visible_boxes_say_the_same(scene: Scene) -> None:
    truth = scene.truth
    assert np.array_equal(truth.instance > 0, truth.body_part > 0)
    assert truth.body_part.max() <= max(PART_CLASSES.values())
    assert np.isfinite(truth.depth_m[truth.instance > 0]).all()
    for somebody in truth.people:
        rows, columns = np.nonzero(truth.instance == somebody.id)
        if len(rows) == 0:
            assert somebody.visible_box is None
            continue
        size = (np.ptp(columns) + 1.0, np.ptp(rows) + 1.0)
        assert somebody.visible_box == (columns.min() - 0.5, rows.min() - 0.5, *size)


def test_parts_of_the_body_lie_where_they_belong(scene: Scene) -> None:
    truth, somebody = scene.truth, scene["in_front"]
    rows = {
        name: np.nonzero((truth.instance == somebody.id) & (truth.body_part == number))[0].mean()
        for name, number in PART_CLASSES.items()
        if np.any((truth.instance == somebody.id) & (truth.body_part == number))
    }
    assert rows["head"] < rows["chest"] < rows["pelvis"] < rows["left_shin"] < rows["left_foot"]


def test_depth_and_distance_are_those_of_the_person(scene: Scene) -> None:
    truth, somebody = scene.truth, scene["in_front"]
    depth = np.median(truth.depth_m[truth.instance == somebody.id])
    eye = truth.world_from_camera[:3, 3]
    assert depth == pytest.approx(somebody.distance_m, abs=0.25)
    assert somebody.distance_m == pytest.approx(np.hypot(*(somebody.position_m - eye[:2])))
    assert somebody.is_counted


@pytest.mark.parametrize(
    ("distance", "counted"), [(2.99, False), (3.0, True), (6.0, True), (10.0, True), (10.01, False)]
)
def test_people_from_3_to_10_m_are_counted(distance: float, counted: bool) -> None:
    assert is_counted(distance, Pinhole()) is counted


@pytest.mark.parametrize(("distance", "counted"), [(1.0, False), (1.1, True), (7.0, True), (7.1, False)])
def test_people_all_round_are_counted_where_panoramas_show_them(distance: float, counted: bool) -> None:
    assert is_counted(distance, Panorama()) is counted


def test_parts_have_temperatures_of_a_body(scene: Scene) -> None:
    temperatures = scene["in_front"].part_temperature_c
    assert set(temperatures) <= set(PART_CLASSES)
    assert 30.0 < temperatures["head"] < 36.0
    assert all(22.0 < value < 37.0 for value in temperatures.values())


def test_truth_cannot_be_written_to(scene: Scene) -> None:
    for array in (scene.truth.instance, scene.truth.depth_m, scene["in_front"].joints_m):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_an_empty_hall_has_nobody(empty: SimulatedWorld) -> None:
    truth = empty.truth()
    assert truth.people == ()
    assert not truth.instance.any()
    assert not truth.body_part.any()
    assert truth.contacts == ()
    assert np.isfinite(truth.depth_m).all()


def test_who_has_not_entered_or_has_left_is_nowhere() -> None:
    guest = person("guest", (3.0, 0.0), enter_s=0.4, leave_s=0.8)
    with SimulatedWorld(config(guest)) as world:
        for tick in range(18):
            is_there = 6 <= tick < 12
            truth, observation = world.truth(), world.observe()
            assert [somebody.name for somebody in truth.people] == ["guest"] * is_there
            assert truth.instance.any() == is_there
            assert (observation.sonar_m[3] < 2.5) == is_there
            assert (observation.images["thermal"][40:110, 70:90].max() > 60) == is_there
            world.step(0.0, 0.0)


def test_the_pose_of_the_camera_follows_the_robot() -> None:
    with SimulatedWorld(config(robot=robot(2.0, 1.0, heading_deg=90.0))) as world:
        truth = world.truth()
    assert truth.camera == SMALL
    assert truth.world_from_camera[:3, 3] == pytest.approx([2.0, 1.14, 1.2], abs=1e-3)
    # Its optical axis is the robot's forward direction, its x axis points to the robot's right.
    assert truth.world_from_camera[:3, 2] == pytest.approx([0.0, 1.0, 0.0], abs=1e-3)
    assert truth.world_from_camera[:3, 0] == pytest.approx([1.0, 0.0, 0.0], abs=1e-3)
    assert (truth.robot.x, truth.robot.y) == pytest.approx((2.0, 1.0), abs=1e-3)
