from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.loop.loop import closed_loop
from peopleboy.sim.world import SimulatedWorld
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame
from peopleboy.tracker.sensors.detections import Detections
from peopleboy.tracker.sensors.thermal.detector.detector import PeopleDetector
from peopleboy.tracker.sensors.thermal.people_finder import ColourFinder, ThermalFinder, merge_cameras
from peopleboy.tracker.sensors.thermal.thermal_sensor import ThermalSensor
from peopleboy.tracker.track import confirmed
from peopleboy.tracker.trackers import make_tracker
from peopleboy.tracker.tracking.config import ColourDetectionConfig, PeopleTrackerConfig
from peopleboy.tracker.tracking.people_tracker import PeopleTracker

CONFIG = ColourDetectionConfig()
NO_DETECTIONS = Detections.from_trees(np.empty((0, 4)), np.empty(0))
ONE = Detections.from_trees(np.array([[100.0, 40.0, 30.0, 100.0]]), np.array([1.0]))


def proposals() -> st.SearchStrategy[Detections]:
    def of(count: int) -> st.SearchStrategy[Detections]:
        boxes = arrays(np.float64, (count, 4), elements=st.floats(5.0, 100.0))
        scores = arrays(np.float64, count, elements=st.floats(-2.0, 4.0))
        return st.builds(lambda box, score: Detections.from_trees(box, -np.sort(-score)), boxes, scores)

    return st.integers(0, 5).flatmap(of)


@given(proposals(), proposals())
def test_colours_take_nobody_away_and_move_nobody(thermal: Detections, colour: Detections) -> None:
    both = merge_cameras(thermal, colour, CONFIG)
    assert (np.diff(both.score) <= 0.0).all()
    for box, score in zip(thermal.box, thermal.score, strict=True):
        rows = (both.box == box).all(axis=1)
        assert rows.any()
        assert both.score[rows].max() >= score
    new = len(both.box) - len(thermal.box)
    assert 0 <= new <= (colour.score >= CONFIG.alone).sum()
    if len(thermal.box) and new:
        alone = [box for box in both.box if not (thermal.box == box).all(axis=1).any()]
        assert all(iou(box, thermal.box).max() < CONFIG.same for box in alone)


def test_of_whom_both_show_the_surer_score_and_the_thermal_box_are_told() -> None:
    colour = Detections.from_trees(ONE.box + np.array([3.0, 2.0, 0.0, 0.0]), np.array([2.5]))
    both = merge_cameras(ONE, colour, CONFIG)
    assert both.score.tolist() == [2.5]
    np.testing.assert_array_equal(both.box, ONE.box)
    assert merge_cameras(colour, ONE, CONFIG).score.tolist() == [2.5]


def test_whom_colours_alone_show_is_told_if_that_is_likely() -> None:
    elsewhere = Detections.from_trees(ONE.box + np.array([80.0, 0.0, 0.0, 0.0]), np.array([2.0]))
    assert merge_cameras(ONE, elsewhere, CONFIG).score.tolist() == [2.0, 1.0]
    assert merge_cameras(NO_DETECTIONS, elsewhere, CONFIG).score.tolist() == [2.0]
    assert merge_cameras(ONE, replace_score(elsewhere, -0.5), CONFIG).score.tolist() == [1.0]
    assert merge_cameras(ONE, NO_DETECTIONS, CONFIG) is ONE


def replace_score(found: Detections, score: float) -> Detections:
    return Detections.from_trees(found.box, np.full(len(found.box), score))


def test_a_part_of_somebody_known_is_nobody_else() -> None:
    head = Detections.from_trees(np.array([[105.0, 42.0, 12.0, 40.0]]), np.array([3.0]))
    assert merge_cameras(ONE, head, CONFIG).score.tolist() == [1.0]


@pytest.fixture(scope="module")
def frames() -> list[Frame]:
    """What a robot sees that stands by while two people cross."""
    scenario, frames, before = load_scenario("crossing_2"), [], None
    with SimulatedWorld(scenario.world(0)) as world:
        tracker = make_tracker("contour")
        for tick in closed_loop(world, tracker, scenario.make_behaviour(), 60):
            frames.append(Frame.from_observation(tick.observation, before))
            before = tick.observation.odometry
    return frames


def without_warmth(frames: list[Frame]) -> Iterator[Frame]:
    """Show the frames as in a room as warm as people: there is nothing but noise in the thermal image."""
    rng = np.random.default_rng(0)
    for frame in frames:
        noise = np.rint(rng.normal(128.0, 3.0, frame.grey(THERMAL).shape)).astype(np.uint8)
        yield replace(frame, images={**frame.images, THERMAL: noise})


@pytest.mark.slow
def test_in_a_room_as_warm_as_people_they_are_found_by_colours(frames: list[Frame]) -> None:
    tracker, thermal = PeopleTracker((ThermalSensor(),)), ThermalFinder(PeopleDetector())
    result, warm = 0, 0
    for frame in without_warmth(frames):
        warm += len(thermal(frame).score)
        result += len(list(confirmed(tracker.update(frame), THERMAL)))
    assert warm < 0.05 * len(frames)
    assert result > 0.3 * len(frames)


def independent_per_s(frames: Iterable[Frame], thermal: Detections) -> list[float]:
    """When something came of looking."""
    find = ColourFinder(CONFIG, PeopleTrackerConfig().existence.weakest)
    return [frame.time_s for frame in frames if find(frame, thermal) is not thermal]


def test_it_looks_now_and_then_and_more_often_while_heat_shows_nobody(frames: list[Frame]) -> None:
    everywhere = Detections.from_trees(np.array([[0.0, 0.0, 320.0, 240.0]]), np.array([5.0]))
    seldom, often = independent_per_s(frames, everywhere), independent_per_s(frames, NO_DETECTIONS)
    assert len(seldom) >= 2
    assert CONFIG.beside_s <= np.diff(seldom).min() < CONFIG.beside_s + 0.1
    assert CONFIG.alone_every_s <= np.diff(often).min() < CONFIG.alone_every_s + 0.1


def test_it_looks_more_seldom_while_heat_shows_somebody(frames: list[Frame]) -> None:
    dark = [replace(one, images={THERMAL: one.grey(THERMAL), COLOUR: 0 * one.rgb(COLOUR)}) for one in frames]
    later = [frame if frame.time_s > 0.5 else nobody for frame, nobody in zip(frames, dark, strict=True)]
    assert CONFIG.every_s <= independent_per_s(later, NO_DETECTIONS)[0] < CONFIG.every_s + 0.1
    surely, hardly = (Detections.from_trees(ONE.box + 200.0, np.array([score])) for score in (0.1, -0.1))
    assert independent_per_s(later, hardly)[0] < CONFIG.every_s + 0.1
    assert independent_per_s(later, surely)[0] >= CONFIG.beside_s


def test_it_looks_where_both_cameras_are_known_and_the_image_is_new(frames: list[Frame]) -> None:
    assert independent_per_s([replace(frame, calibrations={}) for frame in frames], NO_DETECTIONS) == []
    still = frames[len(frames) // 2]
    assert len(independent_per_s([still, replace(still, time_s=still.time_s + 1.0)], NO_DETECTIONS)) <= 1
