from dataclasses import replace

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.studies.reproductions.experiments.learning import learn_pairs
from peopleboy.studies.reproductions.occlusion_splits import (
    learn_split,
    random_split,
    split_by_scenario,
)
from peopleboy.studies.training.occlusion import OcclusionTraining
from peopleboy.studies.training.occlusion_pairs import (
    LEAST,
    Episodes,
    PairSample,
    is_in_front,
    mirror,
    read_pairs,
    share_right,
    write_pairs,
)
from peopleboy.studies.training.specification import train
from peopleboy.tracker.contour.occlusion.learned_table import LearnedTable
from tests.helpers.calls.command_line import refusal
from tests.helpers.calls.refused import assert_names, refused
from tests.helpers.runs.synthetic_ticks import person


def examples(count: int, seed: int) -> list[PairSample]:
    """Pairs of four scenarios, in which a mix of top and bottom tells who is in front, with some noise."""
    rng = np.random.default_rng(seed)
    made = []
    for number in range(count):
        features = rng.normal(0, 0.05, 6)
        is_front = bool(features[2] - features[1] + rng.normal(0, 0.01) > 0)
        made.append(
            PairSample(
                scenario=f"made_up_{number % 4}",
                seed=seed,
                frame=number,
                one="ann",
                other="bob",
                features=features,
                is_front=is_front,
            )
        )
    return made


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
    learned, tested = ({id(one) for one in part} for part in (split.learned, split.tested))
    assert (len(learned), len(tested)) == (73, 48)
    assert not learned & tested
    by_scenario = split_by_scenario(given, np.random.default_rng(0))
    learned, tested = ({one.scenario for one in part} for part in (by_scenario.learned, by_scenario.tested))
    assert len(learned) == 3
    assert not learned & tested
    assert len(by_scenario.learned) + len(by_scenario.tested) == 300


def test_however_uneven_scenarios_are_one_is_left_to_test_with():
    few, many = examples(8, 0), [replace(one, scenario="most") for one in examples(60, 1)]
    for seed in range(10):
        split = split_by_scenario([*few, *many], np.random.default_rng(seed))
        assert split.tested
        assert split.learned


def test_a_feature_that_tells_nothing_is_right_in_half_of_all_answers():
    given = [replace(one, features=one.features * [1, 1, 1, 1, 0, 1]) for one in examples(60, 0)]
    found = learn_split(given, ("colour_o",), 1, 4, np.random.default_rng(0))
    assert (found.held_out, found.unseen, found.table.classifiers) == (50.0, 50.0, ())


def test_as_many_examples_are_positive_as_negative():
    features, is_front = mirror(examples(31, 0))
    assert is_front.sum() == 31
    assert np.array_equal(features[:31], -features[31:])


def test_what_is_trained_says_from_how_much_and_how_well(tmp_path):
    write_pairs(tmp_path / "pairs.csv", examples(100, 0))
    training = OcclusionTraining(sequences=1)
    (path,) = train(training, tmp_path, Workers(), ship=False)
    assert path == tmp_path / "contour.yaml"
    trained = LearnedTable.load(path)
    assert len(trained.classifiers) > 1
    assert "100 pairs" in trained.about["trained on"]
    assert float(trained.about["right on each scenario, trained on the others"].split()[0]) > 85


def test_a_tracker_that_does_not_order_people_is_refused(tmp_path, capsys):
    told = refusal(capsys, "train", "occlusion", "--tracker", "paper", "--out", tmp_path / "out")
    assert_names(told, "--tracker", "paper", "contour", "thesis")


def test_too_few_samples_are_refused():
    with pytest.raises(BadInput, match="at least 20"):
        OcclusionTraining().fit(examples(5, 0))


def test_no_answer_counts_half_and_no_question_nothing():
    assert share_right(np.array([1.0, -1.0, 0.0, 0.2]), np.array([True, True, True, False])) == 37.5
    assert np.isnan(share_right(np.zeros(0), np.zeros(0, bool)))


def test_examples_survive_their_file(tmp_path):
    path = tmp_path / "pairs.csv"
    written = examples(7, 3)
    write_pairs(path, written)
    read = read_pairs(path)
    for one, other in zip(written, read, strict=True):
        assert other.features == pytest.approx(one.features, rel=1e-4)
        assert (one.scenario, one.seed, one.frame, one.one, one.other, one.is_front) == (
            other.scenario, other.seed, other.frame, other.one, other.other, other.is_front,
        )  # fmt: skip


@pytest.mark.parametrize("text", ["a,b\n1,2\n", "scenario,seed\nx,one\n"])
def test_a_file_that_is_no_table_of_examples_is_refused(tmp_path, text):
    path = tmp_path / "pairs.csv"
    path.write_text(text)
    with refused(path, "scenario"):
        read_pairs(path)
    with refused(tmp_path / "nothing.csv"):
        read_pairs(tmp_path / "nothing.csv")


def test_too_few_pairs_of_a_tracker_teach_nothing():
    few, enough = (
        learn_pairs(("top", "bottom"), 2, 5, 0, tuple(examples(count, 1))) for count in (LEAST - 1, LEAST)
    )
    assert np.isnan([few["held out"], few["unseen scenarios"]]).all()
    assert few["best"] == []
    assert enough["held out"] > 60
