import json
import math
from dataclasses import replace

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.studies.reproductions.experiments.learning import (
    learn_pairs,
    random_split,
    split_by_scenario,
)
from peopleboy.studies.training import occlusion, occlusion_pairs
from peopleboy.studies.training.occlusion import (
    LEAST,
    OcclusionTraining,
    share_right,
)
from peopleboy.studies.training.occlusion_pairs import Episodes, PairSamples, collect_pairs, is_in_front
from peopleboy.studies.training.specification import train
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.reproductions.contour.occlusion.learned_table import LearnedTable
from peopleboy.tracker.reproductions.contour.variants import CONTOUR
from tests.helpers.calls.command_line import refusal
from tests.helpers.calls.refused import assert_names
from tests.helpers.runs.synthetic_ticks import person


def examples(count: int, seed: int) -> PairSamples:
    """Pairs of four scenarios, in which a mix of top and bottom tells who is in front, with some noise."""
    rng = np.random.default_rng(seed)
    made = []
    for number in range(count):
        features = rng.normal(0, 0.05, 6)
        is_front = bool(features[2] - features[1] + rng.normal(0, 0.01) > 0)
        made.append((number, "ann", "bob", features, is_front))
    drawn = PairSamples.from_rows("drawn", seed, made)
    return replace(drawn, scenario=np.array([f"made_up_{number % 4}" for number in range(count)]))


def test_whoever_hides_more_of_the_other_is_in_front_and_else_whoever_is_clearly_nearer():
    ann, bob = person(1, "ann", 4.0), person(2, "bob", 6.0)
    assert is_in_front(ann, bob) is True
    assert is_in_front(bob, ann) is False
    assert is_in_front(ann, replace(bob, distance_m=4.2)) is None
    # A corner of the distances: who bends over may hide somebody who stands a little nearer.
    assert is_in_front(ann, replace(bob, distance_m=3.9, hidden_by={"ann": 0.3})) is True
    assert is_in_front(replace(ann, hidden_by={"bob": 0.1}), bob) is False


def test_nothing_is_taken_from_a_total_occlusion_until_the_two_have_been_apart():
    ann, bob = person(1, "ann", 4.0), person(2, "bob", 6.0)
    hidden = replace(bob, visible_fraction=0.05, hidden_by={"ann": 0.95})
    episodes = Episodes()
    assert [episodes.takes(ann, bob, frame) for frame in range(1, 6)] == [True, False, True, False, True]
    assert not episodes.takes(ann, hidden, 6)
    assert not any(episodes.takes(ann, bob, frame) for frame in range(7, 20))
    assert episodes.takes(bob, ann, 60)


def test_no_pair_and_no_scenario_is_both_learned_from_and_tested_on():
    given = examples(300, 0)
    split = random_split(given, np.random.default_rng(0))
    learned, tested = (set(part.frame.tolist()) for part in split)
    assert (len(learned), len(tested)) == (73, 48)
    assert not learned & tested
    by_scenario = split_by_scenario(given, np.random.default_rng(0))
    learned, tested = (set(part.scenario.tolist()) for part in by_scenario)
    assert len(learned) == 3
    assert not learned & tested
    assert sum(map(len, by_scenario)) == 300


def test_however_uneven_scenarios_are_one_is_left_to_test_with():
    many = replace(examples(60, 1), scenario=np.full(60, "most"))
    for seed in range(10):
        split = split_by_scenario(PairSamples.join([examples(8, 0), many]), np.random.default_rng(seed))
        assert all(len(part) for part in split)


def test_a_feature_that_tells_nothing_is_right_in_half_of_all_answers():
    given = examples(60, 0)
    given = replace(given, features=given.features * [1, 1, 1, 1, 0, 1])
    found = learn_pairs(("colour_o",), 1, 4, 0, given, given)
    assert found == {"held out": 50.0, "unseen scenarios": 50.0, "feet cut off": 50.0, "best": []}


def test_as_many_examples_are_positive_as_negative():
    features, is_front = examples(31, 0).mirror()
    assert is_front.sum() == 31
    assert np.array_equal(features[:31], -features[31:])


def test_what_is_trained_says_from_how_much_and_how_well(tmp_path, monkeypatch):
    monkeypatch.setattr(occlusion, "SCENARIOS", ["drawn"])
    training = OcclusionTraining(sequences=1)
    (task,) = training.tasks(tmp_path).training
    task.path.parent.mkdir()
    examples(100, 0).save(task.path)
    (path,) = train(training, tmp_path, Workers(), ship=False)
    assert path == tmp_path / "contour.yaml"
    trained = LearnedTable.load(path)
    assert len(trained.classifiers) > 1
    assert "100 pairs" in trained.about["trained on"]
    assert float(trained.about["accuracy on each scenario, trained on the others"].split()[0]) > 85


def test_a_tracker_that_does_not_order_people_is_refused(tmp_path, capsys):
    told = refusal(capsys, "train", "occlusion", "--tracker", "paper", "--out", tmp_path / "out")
    assert_names(told, "--tracker", "paper", "contour", "thesis")


def test_too_few_samples_are_refused():
    with pytest.raises(BadInput, match="at least 20"):
        OcclusionTraining().fit(examples(5, 0))


def test_no_answer_counts_half_and_no_question_nothing():
    assert share_right(np.array([1.0, -1.0, 0.0, 0.2]), np.array([True, True, True, False])) == 37.5
    assert np.isnan(share_right(np.zeros(0), np.zeros(0, bool)))


@pytest.mark.parametrize("count", [0, 7])
def test_examples_survive_their_file_and_plain_data(count, tmp_path):
    written = examples(count, 3)
    written.save(tmp_path / "pairs.npz")
    plain = json.loads(json.dumps(written.to_plain()))
    for read in (PairSamples.load(tmp_path / "pairs.npz"), PairSamples.from_plain(plain)):
        for name, array in written.arrays().items():
            np.testing.assert_array_equal(getattr(read, name), array, strict=True)


def test_too_few_pairs_of_a_tracker_teach_nothing():
    few, enough = (
        learn_pairs(("top", "bottom"), 2, 5, 0, examples(count, 1), examples(40, 1))
        for count in (LEAST - 1, LEAST)
    )
    assert np.isnan([few["held out"], few["unseen scenarios"]]).all()
    assert few["feet cut off"] > 60
    assert few["best"] == []
    assert enough["held out"] > 60


def test_a_camera_that_is_tilted_up_sees_no_feet_within_11_m():
    world = occlusion_pairs._tilted(load_scenario("crossing_pair").world(0), math.radians(16.0))
    camera = world.robot.cameras[THERMAL].camera
    sees_floor_from = camera.position_m[2] / math.tan(camera.vertical_fov_rad / 2.0 + camera.pitch_rad)
    assert 11.0 < sees_floor_from < 12.0
    before = load_scenario("crossing_pair").world(0).robot.cameras
    assert {name for name, one in world.robot.cameras.items() if one != before[name]} == {THERMAL}


@pytest.mark.thorough
def test_noise_of_labels_is_drawn_from_the_seed_and_leaves_features_unchanged():
    exact, noisy, again = (
        collect_pairs("crossing_pair", 0, CONTOUR, label_noise_px=noise) for noise in (0.0, 12.0, 12.0)
    )
    np.testing.assert_array_equal(noisy.frame, again.frame)
    measured = dict(zip(exact.frame.tolist(), exact.features, strict=True))
    both = [row for row, frame in enumerate(noisy.frame.tolist()) if frame in measured]
    assert both
    for row in both:
        expected = measured[int(noisy.frame[row])]
        np.testing.assert_allclose(np.abs(noisy.features[row]), np.abs(expected))
