"""One track for one person, by trackers that say what a test wants them to."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.tracker.contour.explanation import ContourExplanation
from peopleboy.tracker.contour.variants import CONTOUR
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, PANORAMA, THERMAL, Frame, Odometry
from peopleboy.tracker.fusion.fused_tracker import FusedTracker, ThermalDepthTracker
from peopleboy.tracker.fusion.fusion_config import FusionConfig
from peopleboy.tracker.panoramic.people.panoramic_observation import PeopleExplanation
from peopleboy.tracker.rgbd.observation_model import BINS, Body
from peopleboy.tracker.track import Box, FloorPlace, Status, Track
from tests.helpers.depth_scene import FOCAL_PX, HEIGHT, WIDTH, Block, depth_of, make_view
from tests.helpers.images.cardboard import CAMERA
from tests.helpers.runs.hand_made_tracks import track
from tests.helpers.runs.synthetic_ticks import ELLIPSE

CALIBRATION = make_view().calibration
TALL_M = 1.65
RED, BLUE, GREEN = 5, 50, 29
PAINT = {RED: (230, 20, 20), BLUE: (20, 20, 230), GREEN: (20, 230, 20)}
HIDDEN = Status.TOTALLY_OCCLUDED


def appearance(colour: int) -> np.ndarray:
    found = np.zeros(BINS)
    found[colour] = 1.0
    return found


class Heat:
    """A thermal tracker."""

    cameras = (THERMAL,)

    def __init__(self) -> None:
        self.tracks: tuple[Track, ...] = ()
        self.odometry: list[Odometry | None] = []
        self.introduced: list[Box] = []

    def update(self, frame: Frame) -> tuple[Track, ...]:
        self.odometry.append(frame.odometry)
        return self.tracks

    def introduce(self, box: Box) -> None:
        self.introduced.append(box)

    @property
    def explanation(self) -> ContourExplanation:
        ids = [one.id for one in self.tracks]
        return ContourExplanation(
            config=CONTOUR, ellipses=dict.fromkeys(ids, ELLIPSE), spread_px2=dict.fromkeys(ids, 1.0)
        )


class Depth:
    """A tracker by depth."""

    cameras = (DEPTH,)

    def __init__(self) -> None:
        self.explanation: Any = None

    def update(self, frame: Frame) -> tuple[Track, ...]:
        self.explanation = SimpleNamespace(
            hypotheses=[
                SimpleNamespace(
                    id=one.id, place_m=np.array(one.place.position_m), seen_s=frame.time_s, body=body(colour)
                )
                for one, colour in self.reported
                if one.place is not None
            ],
            detections=[
                SimpleNamespace(place_m=np.array(one.place.position_m), body=body(colour))
                for one, colour in self.reported
                if one.place is not None and one.status is not HIDDEN
            ],
        )
        return tuple(one for one, _ in self.reported)

    reported: Sequence[tuple[Track, int]] = ()


def body(colour: int) -> Body:
    return Body(width_m=0.45, head_m=TALL_M, low_m=0.0, appearance=appearance(colour))


def is_at(one: Track, block: Block) -> bool:
    return one.place is not None and math.dist(one.place.position_m, (block.z_m + 0.1, -block.x_m)) < 0.05


def pixels_of(block: Block, depth: np.ndarray) -> np.ndarray:
    """Whether a pixel (H, W) shows a block."""
    off_m = (np.arange(WIDTH) - (WIDTH - 1) / 2) / FOCAL_PX * block.z_m - block.x_m
    return np.asarray((depth == round(1000 * block.z_m)) & (np.abs(off_m) <= block.width_m / 2))


class Around:
    """A panoramic tracker."""

    cameras = (PANORAMA,)
    tracks: tuple[Track, ...] = ()
    explanation: PeopleExplanation | None = None

    def update(self, frame: Frame) -> tuple[Track, ...]:
        del frame
        return self.tracks

    def check_cameras(self, calibrations: Any) -> None:
        del calibrations
        raise BadInput("another mirror")


class Scene:
    """People at places, of whom the trackers tell what they are told to."""

    def __init__(self) -> None:
        self.heat, self.depth, self.around = Heat(), Depth(), Around()
        ahead = ThermalDepthTracker(self.heat, self.depth, FusionConfig())  # type: ignore[arg-type]
        self.tracker = FusedTracker(ahead, self.around)  # type: ignore[arg-type]
        self.k = 0
        self.clothes: dict[Block, int] = {}

    def see(
        self,
        *blocks: Block,
        warm: Sequence[Track] = (),
        deep: Sequence[tuple[Track, int]] = (),
        grey: int = 120,
        without: Sequence[str] = (),
        has_panorama: bool = False,
    ) -> dict[int, Track]:
        self.k += 1
        self.heat.tracks, self.depth.reported = tuple(warm), tuple(deep)
        self.clothes = {block: colour for block in blocks for one, colour in deep if is_at(one, block)}
        images: dict[str, Any] = {
            THERMAL: np.full((HEIGHT, WIDTH), grey, np.uint8),
            DEPTH: depth_of(list(blocks)).copy(),  # to be drawn into
            DEPTH_COLOUR: np.full((HEIGHT, WIDTH, 3), 120, np.uint8),
        }
        for block, colour in self.clothes.items():
            images[DEPTH_COLOUR][pixels_of(block, images[DEPTH])] = PAINT[colour]
        images[THERMAL][0, 0] = images[DEPTH][0, 0] = self.k % 200  # no two images are equal
        calibrations: dict[str, Any] = {THERMAL: CALIBRATION, DEPTH: CALIBRATION}
        if has_panorama:
            calibrations[PANORAMA] = CAMERA
        kept = {name: image for name, image in images.items() if name not in without}
        frame = Frame(images=kept, time_s=self.k / 15.0, calibrations=calibrations, odometry=Odometry())
        return {one.id: one for one in self.tracker.update(frame)}


def by_heat(number: int, block: Block, off_m: float = 0.0, **further: Any) -> Track:
    """A thermal track: sure of the bearing, wrong in range by so much."""
    x, y = block.z_m + 0.1, -block.x_m
    factor = 1.0 + off_m / math.hypot(x, y)
    (u, top), (_, bottom) = CALIBRATION.project(np.array([[x, y, TALL_M], [x, y, 0.0]])).tolist()
    width = 0.2 * (bottom - top)
    place = FloorPlace(position_m=(x * factor, y * factor), covariance_m2=(0.5**2, 0.0, 0.05**2))
    box = (u - width / 2.0, top - 5.0, width, bottom - top + 9.0)
    return replace(track(number, boxes={THERMAL: box}, **further), place=place)


def by_depth(number: int, block: Block, colour: int = RED, **further: Any) -> tuple[Track, int]:
    return track(number, (block.z_m + 0.1, -block.x_m), deviation_m=0.04, **further), colour


def test_one_person_has_one_track_with_the_best_of_both() -> None:
    scene, someone = Scene(), Block(0.4, 5.0)
    for _ in range(10):
        seen = scene.see(someone, warm=[by_heat(7, someone, off_m=0.5)], deep=[by_depth(3, someone)])
    (one,) = seen.values()
    assert one.id == 1
    assert one.place is not None
    assert one.place.position_m == pytest.approx((5.1, -0.4), abs=0.06)
    left, top, width, height = one.boxes[THERMAL]
    (u, head), (_, feet) = CALIBRATION.project(np.array([[5.1, -0.4, TALL_M], [5.1, -0.4, 0.0]])).tolist()
    assert (left + width / 2, top, top + height) == pytest.approx((u, head, feet), abs=1.5)


@pytest.mark.parametrize("camera", [THERMAL, DEPTH])
def test_a_camera_that_stays_out_leaves_the_other_one(camera: str) -> None:
    scene = Scene()
    for k in range(40):
        someone = Block(0.03 * k - 0.6, 5.0)
        without = [camera] if 10 <= k < 30 else []
        seen = scene.see(someone, warm=[by_heat(7, someone)], deep=[by_depth(3, someone)], without=without)
        assert list(seen) == [1]
        assert seen[1].place is not None
        assert seen[1].place.position_m[1] == pytest.approx(-someone.x_m, abs=0.15)
    if camera == THERMAL:
        assert len(scene.heat.odometry) == 20


def test_without_any_image_everybody_is_gone_soon_but_comes_back() -> None:
    scene, someone = Scene(), Block(0.0, 5.0)
    warm, deep = [by_heat(7, someone)], [by_depth(3, someone)]
    for _ in range(10):
        scene.see(someone, warm=warm, deep=deep)
    for _ in range(12):
        seen = scene.see(without=[THERMAL, DEPTH])
    assert seen == {}
    assert list(scene.see(someone, warm=warm, deep=deep)) == [1]


def test_a_warm_track_that_depth_sees_through_is_dropped() -> None:
    scene, someone = Scene(), Block(0.0, 4.0)
    assert scene.see(warm=[by_heat(7, someone)]) == {}
    assert list(scene.see(someone, warm=[by_heat(7, someone)])) == [1]


def test_what_is_cold_is_nobody() -> None:
    scene, thing = Scene(), Block(0.0, 4.0)
    assert scene.see(thing, deep=[by_depth(3, thing)], grey=10) == {}
    assert list(scene.see(thing, deep=[by_depth(3, thing)])) == [1]


def test_people_who_cross_keep_their_numbers_whatever_the_trackers_do() -> None:
    """The thermal tracker changes their numbers, and the one by depth gives new ones after the crossing."""
    scene = Scene()
    for k in range(60):
        near, far = Block(1.2 - 0.04 * k, 4.0), Block(0.04 * k - 1.2, 6.0)
        is_hidden, is_after = abs(near.x_m / 4.0 - far.x_m / 6.0) < 0.08, k > 30
        warm = [by_heat(2 if is_after else 1, near), by_heat(1 if is_after else 2, far)]
        deep = [by_depth(3, near, RED), by_depth(9 if is_after else 4, far, BLUE)]
        shown = slice(0, 1) if is_hidden else slice(0, 2)
        seen = scene.see(far, near, warm=warm[shown], deep=deep[shown])
        if k in (10, 59):
            there = {round(one.place.position_m[0]): number for number, one in seen.items() if one.place}
            assert there == {4: 1, 6: 2}


def test_two_who_are_known_stay_two_when_heat_takes_one_for_the_other() -> None:
    """Heat has only the one behind, and takes the one in front for her while she is hidden."""
    scene = Scene()
    for k in range(70):
        near, far = Block(0.9 - 0.03 * k, 4.0), Block(0.03 * k - 0.9, 5.0)
        is_hidden = abs(near.x_m / 4.0 - far.x_m / 5.0) < 0.12
        warm = [by_heat(2, near, off_m=0.6) if is_hidden else by_heat(2, far)]
        deep = [by_depth(3, near, RED), by_depth(4, far, BLUE)]
        seen = scene.see(far, near, warm=warm, deep=deep[: 1 if is_hidden else 2])
        if k in (10, 69):
            there = {round(one.place.position_m[0]): number for number, one in seen.items() if one.place}
            assert there == {4: 1, 5: 2}


def test_a_contour_that_drifts_away_takes_neither_box_nor_place_along() -> None:
    scene, someone, ahead = Scene(), Block(0.0, 5.0), Block(0.45, 5.0)
    for _ in range(10):
        scene.see(someone, ahead, warm=[by_heat(7, someone)], deep=[by_depth(3, someone)])
    before = scene.see(someone, ahead, warm=[by_heat(7, someone)], deep=[by_depth(3, someone)])[1]
    for _ in range(10):
        after = scene.see(someone, ahead, warm=[by_heat(7, ahead)], deep=[by_depth(3, someone)])
    assert set(after) == {1}
    assert after[1].place is not None
    assert after[1].place.position_m == pytest.approx((5.1, 0.0), abs=0.05)
    assert after[1].boxes[THERMAL] == pytest.approx(before.boxes[THERMAL], abs=2.5)


def test_two_who_were_taken_for_each_other_are_known_by_their_looks() -> None:
    scene = Scene()
    left, right = Block(-1.0, 5.0), Block(1.0, 5.0)
    for _ in range(20):
        scene.see(left, right, deep=[by_depth(1, left, RED), by_depth(2, right, BLUE)])
    for _ in range(20):
        seen = scene.see(left, right, deep=[by_depth(1, left, BLUE), by_depth(2, right, RED)])
    places = {number: one.place.position_m[1] > 0 for number, one in seen.items() if one.place}
    assert places == {1: False, 2: True}


def test_who_comes_back_after_long_is_known_by_looks() -> None:
    scene, here, there = Scene(), Block(-1.0, 5.0), Block(1.2, 5.0)
    for _ in range(20):
        scene.see(here, deep=[by_depth(1, here, RED)])
    for _ in range(100):
        scene.see()
    assert list(scene.see(there, deep=[by_depth(5, there, BLUE)])) == [2]
    assert set(scene.see(there, here, deep=[by_depth(5, there, BLUE), by_depth(6, here, RED)])) == {1, 2}


def test_who_turns_up_without_looks_is_told_when_they_are_seen_or_late_enough() -> None:
    """Of whom too little is seen for colours it is not decided who it is for half a second."""
    scene, here, front = Scene(), Block(-1.0, 5.0), Block(0.62, 3.0, width_m=0.7)
    for _ in range(20):
        scene.see(here, deep=[by_depth(1, here, RED)])
    for _ in range(60):
        scene.see()
    there = Block(1.05, 5.0)
    covered = [list(scene.see(front, there, deep=[by_depth(5, there, BLUE)])) for _ in range(10)]
    assert covered[:7] == [[]] * 7
    assert covered[-1] == [2]
    back = Block(-1.2, 5.0)
    assert list(scene.see(back, deep=[by_depth(6, back, RED)])) == [1]


def test_of_whom_it_is_not_decided_who_it_is_nothing_is_told() -> None:
    """Neither a contour nor whom it hides."""
    scene, here, there, behind = Scene(), Block(-1.0, 5.0), Block(1.0, 4.0), Block(0.0, 6.0)
    for _ in range(20):
        scene.see(here, deep=[by_depth(1, here, RED)])
    for _ in range(60):
        scene.see(behind, deep=[by_depth(2, behind, BLUE)])
    warm = [by_heat(7, there), by_heat(8, behind, status=Status.PARTLY_OCCLUDED, occluder=7)]
    seen = scene.see(behind, there, warm=warm, deep=[by_depth(2, behind, BLUE)])
    assert set(seen) == set(scene.tracker.explanation.both.thermal.ellipses) == {2}
    assert seen[2].occluder is None


def test_two_who_come_back_at_once_are_told_apart_by_looks() -> None:
    """Each where the other one was last seen, with the other one's track by depth."""
    scene, left, right = Scene(), Block(-0.6, 5.0), Block(0.6, 5.0)
    for _ in range(20):
        scene.see(left, right, deep=[by_depth(1, left, RED), by_depth(2, right, BLUE)])
    for _ in range(30):
        scene.see()
    for _ in range(3):
        seen = scene.see(left, right, deep=[by_depth(1, left, BLUE), by_depth(2, right, RED)])
        places = {number: one.place.position_m[1] > 0 for number, one in seen.items() if one.place}
        assert places == {1: False, 2: True}


def test_whose_track_drifted_away_keeps_the_number_where_the_looks_are() -> None:
    """The track by depth goes off with a thing beside, and a new one finds the person."""
    scene, someone, thing = Scene(), Block(0.0, 5.0), Block(0.7, 5.0)
    for _ in range(20):
        scene.see(someone, deep=[by_depth(1, someone, RED)])
    for k in range(12):
        beside = replace(thing, x_m=min(0.12 * k, 0.7))
        reported = [by_depth(1, beside, GREEN)] + ([by_depth(7, someone, RED)] if k > 8 else [])
        seen = scene.see(someone, beside, deep=reported)
    assert seen[1].place is not None
    assert seen[1].place.position_m == pytest.approx((5.1, 0.0), abs=0.1)


def test_somebody_covered_in_part_is_shown_where_depth_sees_it() -> None:
    scene, someone = Scene(), Block(0.0, 5.0)
    for _ in range(15):
        scene.see(someone, deep=[by_depth(1, someone)])
    front = Block(-0.5, 3.0, width_m=0.8)
    for _ in range(20):
        seen = scene.see(front, someone)
    assert seen[1].status is Status.PARTLY_OCCLUDED
    assert seen[1].place is not None
    assert seen[1].place.position_m == pytest.approx((5.1, 0.0), abs=0.08)


def test_who_hides_whom_is_told_by_their_numbers() -> None:
    scene, near, far = Scene(), Block(0.0, 3.0), Block(0.6, 5.0)
    deep = [by_depth(8, near), by_depth(9, far, BLUE, status=Status.PARTLY_OCCLUDED, occluder=8)]
    seen = scene.see(far, near, deep=deep)
    assert seen[2].occluder == 1


def test_somebody_behind_the_robot_keeps_the_number_in_the_panorama() -> None:
    scene, someone = Scene(), Block(0.0, 3.0)
    around = track(4, (3.1, 0.0), boxes={PANORAMA: (100.0, 50.0, 20.0, 60.0)})
    for _ in range(20):
        scene.around.tracks = (around,)
        seen = scene.see(someone, warm=[by_heat(7, someone)], deep=[by_depth(3, someone)], has_panorama=True)
    (number,) = seen
    assert set(seen[number].boxes) == {THERMAL, DEPTH, PANORAMA}
    assert list(scene.see(has_panorama=True)) == [number]
    assert scene.tracker.explanation.both.panoramic is None


def test_explanations_are_by_the_numbers_of_the_tracks() -> None:
    scene, someone = Scene(), Block(0.0, 4.0)
    scene.see(someone, warm=[by_heat(7, someone)], deep=[by_depth(3, someone)])
    explanation = scene.tracker.explanation
    assert set(explanation.both.thermal.ellipses) == {1}
    assert explanation.depth is scene.depth.explanation


def test_cameras_that_will_not_do_are_refused() -> None:
    tracker = Scene().tracker
    with pytest.raises(BadInput, match="calibrated"):
        tracker.check_cameras({})
    with pytest.raises(BadInput, match="mirror"):
        tracker.check_cameras({DEPTH: CALIBRATION, PANORAMA: CAMERA})
    tracker.check_cameras({DEPTH: CALIBRATION})
