import math
from dataclasses import replace

import numpy as np
import pytest

from peopleboy.studies.training.distance import Backpropagation, fit_distances
from peopleboy.tracker.networks.weights_archive import WeightsArchive
from peopleboy.tracker.reproductions.panoramic import distance_network
from peopleboy.tracker.reproductions.panoramic.depth_cues import measure
from peopleboy.tracker.reproductions.panoramic.distance_network import DistanceModel, shipped_models
from peopleboy.tracker.reproductions.panoramic.paper_tracker import PanoramicConfig, PanoramicPaperTracker
from peopleboy.tracker.reproductions.panoramic.position_filter import PRINTED
from peopleboy.tracker.sensors.panorama.panorama_view import view_of
from peopleboy.tracker.track import Status
from peopleboy.tracker.trackers import make_tracker
from tests.helpers.calls.refused import refused
from tests.helpers.images.drawn_panoramas import (
    HEIGHT,
    WIDTH,
    DrawnMirror,
    draw,
    empty_hall,
    frame,
    person_mask,
)


@pytest.fixture(scope="module")
def model():
    rng = np.random.default_rng(0)
    distances = rng.uniform(1.2, 6.0, 200)
    cues = np.array([measure(person_mask(d, rng.uniform(-3.1, 3.1))).cues for d in distances])
    return DistanceModel(
        network=fit_distances(cues, distances, rng, Backpropagation(epochs=1000)),
        view=view_of(DrawnMirror(), WIDTH, HEIGHT),
        noise=PRINTED,
        about={"trained on": "drawn people"},
    )


class Walker:
    """Shows a tracker a hall three times a second, first empty, then with a person round the robot."""

    def __init__(self, model, **config):
        self.rng, self.tick = np.random.default_rng(5), 0
        self.tracker = PanoramicPaperTracker([model], PanoramicConfig(**config))

    def see(self, distance=None, angle=0.0, **further):
        image = empty_hall(self.rng)
        if distance is not None:
            image = draw(image, person_mask(distance, angle))
        self.tick += 1
        return self.tracker.update(frame(self.tick / 3, image, **further))

    def learn(self):
        assert [self.see() for _ in range(5)] == [()] * 5
        return self


def test_a_person_who_walks_round_the_robot_is_one_track_at_the_right_place(model):
    walker = Walker(model).learn()
    for angle in np.linspace(-0.5, math.tau - 0.5, 60):
        (track,) = walker.see(3.0, angle)
        assert track.id == 1
        assert track.status is Status.TRACKED
        place = 3.0 * np.array([math.cos(angle), math.sin(angle)])
        assert np.linalg.norm(track.place.position_m - place) < 0.3
        assert track.boxes["panorama"] == measure(person_mask(3.0, angle)).box


def test_a_box_across_the_seam_begins_inside_the_image_and_ends_beyond(model):
    (track,) = Walker(model).learn().see(2.0, math.pi)
    left, _, width, _ = track.boxes["panorama"]
    assert 0 <= left < WIDTH < left + width


def test_between_images_the_person_goes_on_by_the_last_step_and_grows_uncertain(model):
    walker = Walker(model).learn()
    for angle in (0.0, 0.1, 0.2):
        (seen,) = walker.see(3.0, angle)
    later, latest = (walker.tracker.update(frame(walker.tick / 3 + dt))[0] for dt in (1 / 6, 1 / 3))
    way = np.subtract(later.place.position_m, seen.place.position_m)
    assert np.linalg.norm(way) > 0.05
    np.testing.assert_allclose(np.subtract(latest.place.position_m, seen.place.position_m), 2 * way)
    spread = np.subtract(latest.place.covariance_m2, seen.place.covariance_m2)
    np.testing.assert_allclose(spread, [0.024, -0.001, 0.043], atol=1e-12)
    assert later.boxes == latest.boxes == {} != seen.boxes
    assert latest.age_s == pytest.approx(1.0)


def test_who_was_gone_for_long_comes_back_under_a_new_number(model):
    walker = Walker(model).learn()
    assert walker.see(2.5, 1.0)[0].id == 1
    (unseen,) = walker.see()
    assert (unseen.id, unseen.status) == (1, Status.TOTALLY_OCCLUDED)
    assert walker.see(2.5, 1.0)[0].id == 1
    assert [walker.see() for _ in range(5)][-1] == ()
    assert walker.see(2.5, 1.0)[0].id == 2


def test_a_robot_that_turned_by_its_odometry_keeps_places_in_its_own_frame(model):
    from peopleboy.tracker.frame import Odometry

    walker = Walker(model).learn()
    walker.see(3.0, 0.0)
    turn = Odometry(turn_rad=math.pi / 2)
    (track,) = walker.tracker.update(frame(walker.tick / 3, odometry=turn))
    assert track.place.position_m == pytest.approx((0.0, -3.0), abs=0.3)
    np.testing.assert_allclose(track.place.covariance_m2, [0.020, 0.004, 0.011])


def test_the_covariance_at_first_is_that_of_a_measurement(model):
    (track,) = Walker(model).learn().see(3.0, 0.0)
    assert track.place.covariance_m2 == pytest.approx((0.011, -0.004, 0.020))


def test_it_explains_what_it_saw(model):
    walker = Walker(model).learn()
    assert walker.tracker.explanation is None
    walker.see(3.0, 0.0)
    told = walker.tracker.explanation
    assert np.array_equal(told.silhouette.sum(axis=0), told.figure.columns)
    assert told.distance_m == pytest.approx(model.network.predict(np.array([told.figure.cues]))[0])
    assert told.background.mean.shape == (HEIGHT, WIDTH, 3)
    walker.see()
    assert walker.tracker.explanation.figure is None


def test_a_file_gives_the_same_model_to_the_last_digit(model, tmp_path):
    model.save(tmp_path / "a.npz")
    loaded = DistanceModel.load(tmp_path / "a.npz")
    loaded.save(tmp_path / "b.npz")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    cues = np.array([[20.0, 30.0, 900.0]])
    assert loaded.network.predict(cues) == model.network.predict(cues)
    assert loaded.view == model.view
    assert loaded.about == model.about


BROKEN = {
    "hidden": (np.ones((4, 3)), "hidden must be finite float64 (units, 4)"),
    "output": (np.ones(4), "one weight more than hidden"),
    "cue_ranges": (np.array([[0, 1], [0, 1], [2.0, 1]]), "less to more"),
    "distance_range_m": (np.array([np.nan, 5.0]), "distance_range_m"),
}


@pytest.mark.parametrize("key", BROKEN)
def test_a_file_with_something_wrong_is_refused_by_its_name_and_what_it_is(model, tmp_path, key):
    path = tmp_path / "model.npz"
    value, clue = BROKEN[key]
    model.save(path)
    with np.load(path) as archive:
        arrays = {name: archive[name] for name in archive}
    np.savez(path, **(arrays | {key: value}))
    with refused(path, clue):
        DistanceModel.load(path)


def test_a_camera_that_is_none_is_refused(model, tmp_path):
    model.save(tmp_path / "model.npz")
    with np.load(tmp_path / "model.npz") as archive:
        arrays = {name: archive[name] for name in archive if name not in ("about", "camera")}
    WeightsArchive(arrays, camera={"width_px": 480}).save(tmp_path / "model.npz")
    with refused(tmp_path / "model.npz", "not a file of weights", "peopleboy train distance"):
        DistanceModel.load(tmp_path / "model.npz")


def test_a_missing_file_and_a_tracker_without_one_name_the_command_that_makes_one(tmp_path, monkeypatch):
    with refused(tmp_path / "none.npz", "peopleboy train distance"):
        DistanceModel.load(tmp_path / "none.npz")
    monkeypatch.setattr(distance_network, "shipped_models", lambda: shipped_models(tmp_path / "none"))
    with refused("panoramic-paper", "none", "peopleboy train distance --ship"):
        make_tracker("panoramic-paper")


def test_images_of_another_size_are_refused(model):
    with refused("240x60", "480x120"):
        PanoramicPaperTracker([model]).update(frame(0.0, np.zeros((60, 240, 3), np.uint8)))


def test_images_of_another_mirror_are_refused(model):
    image = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    other = {"panorama": DrawnMirror(lowest_deg=35.0)}
    with refused("8.0 to 35.0 deg", "8.0 to 55.0 deg", "peopleboy train distance"):
        PanoramicPaperTracker([model]).update(replace(frame(0.0, image), calibrations=other))


def test_footage_of_an_unknown_camera_is_taken_if_its_size_is_right(model):
    image = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    assert PanoramicPaperTracker([model]).update(replace(frame(0.0, image), calibrations={})) == ()
