import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from peopleboy.bad_input import BadInput
from peopleboy.studies.training.occlusion import boost
from peopleboy.studies.training.weak_classifiers import weighted_sums
from peopleboy.tracker.reproductions.contour.contour_config import DepthOrderConfig
from peopleboy.tracker.reproductions.contour.occlusion.learned_order import (
    LearnedOrder,
    make_order,
    shipped_order,
)
from peopleboy.tracker.reproductions.contour.occlusion.learned_table import (
    TABLES,
    LearnedTable,
    WeakClassifier,
)
from peopleboy.tracker.reproductions.contour.occlusion.pair_features import FEATURES
from tests.helpers.calls.refused import refused

WEAK = (
    WeakClassifier(weights={"top": 1.0}, threshold=0.5, parity=1, importance=2.0),
    WeakClassifier(weights={"bottom": 1.0, "colour": -0.5}, threshold=0.0, parity=-1, importance=1.0),
)
TABLE = LearnedTable(scale=dict.fromkeys(FEATURES, 2.0), classifiers=WEAK, about={"trained on": "nothing"})
GOOD = """
scale: {strength: 1.0, top: 1.0, bottom: 1.0, colour: 1.0, colour_o: 1.0, colour_no: 1.0}
classifiers:
- weights: {top: 1.0, colour: -0.35}
  threshold: 0.25
  parity: -1
  importance: 1.5
"""

six = arrays(np.float64, 6, elements=st.floats(-5, 5))


def made_examples(count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Pairs, and their mirror images, whose order two features tell together, and neither alone."""
    rng = np.random.default_rng(seed)
    features = rng.standard_normal((count, 6)) * [1, 2, 3, 1, 1, 1]
    is_front = features[:, 1] / 2 - 0.8 * features[:, 2] / 3 > 0
    return np.concatenate([features, -features]), np.concatenate([is_front, ~is_front])


@given(six)
def test_votes_are_those_of_the_weak_classifiers_by_hand(features):
    first = 2 / 3 if features[1] / 2 < 0.5 else -2 / 3
    second = 1 / 3 if (features[2] - 0.5 * features[3]) / 2 > 0 else -1 / 3
    assert LearnedOrder.build(TABLE).votes(features[None])[0] == pytest.approx(first + second)


@given(six)
def test_the_mirrored_pair_has_the_opposite_lead(features):
    order = LearnedOrder.build(TABLE)
    assert order.lead(-features[None])[0] == -order.lead(features[None])[0]


def test_boosted_pairs_find_an_order_that_no_single_feature_tells():
    features, is_front = made_examples(300, 0)
    unseen, truth = made_examples(300, 1)
    right = {}
    for most in (1, 2):
        lead = LearnedOrder.build(boost(features, is_front, most=most)).lead(unseen)
        right[most] = ((lead > 0) == truth).mean()
    assert right[2] > 0.95
    assert right[1] < right[2]


def test_the_table_votes_as_the_boosted_classifier_that_it_was_made_from():
    from sklearn.ensemble import AdaBoostClassifier
    from sklearn.tree import DecisionTreeClassifier

    features, is_front = made_examples(200, 2)
    table = boost(features, is_front, rounds=15)
    scaled = features / features.std(axis=0)
    reference = AdaBoostClassifier(DecisionTreeClassifier(max_depth=1), n_estimators=15, random_state=0)
    reference.fit(scaled @ weighted_sums(6, 2).T, is_front)
    ours = LearnedOrder.build(table).votes(features) > 0
    assert (ours == is_front).mean() >= reference.score(scaled @ weighted_sums(6, 2).T, is_front) - 0.03


def test_learning_uses_only_the_features_it_is_given():
    features, is_front = made_examples(100, 3)
    table = boost(features, is_front, uses=("strength", "top", "bottom"))
    used = {name for weak in table.classifiers for name in weak.weights}
    assert used <= {"strength", "top", "bottom"}


def test_examples_without_any_difference_are_refused():
    with pytest.raises(BadInput, match="nothing to train on"):
        boost(np.zeros((10, 6)), np.arange(10) < 5)


def test_a_table_survives_its_file(tmp_path):
    path = tmp_path / "order.yaml"
    TABLE.save(path)
    assert LearnedTable.load(path) == TABLE


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (("parity: -1", "parity: 0"), "classifiers.0.parity"),
        (("top: 1.0, colour: -0.35", "size: 1.0"), "classifiers.0.weights.size"),
        (("importance: 1.5", "importance: -1.0"), "classifiers.0.importance"),
        (("threshold: 0.25", "threshold: .nan"), "classifiers.0.threshold"),
        (("threshold: 0.25", "threshold: low"), "classifiers.0.threshold"),
        (("colour_no: 1.0}", "colour_no: 0.0}"), "scale.colour_no"),
        ((", colour_no: 1.0", ""), "scale"),
        (("classifiers:", "weak:"), "classifiers"),
        ((GOOD, "[1, 2"), "cannot be read"),
        ((GOOD, "- 1"), "the file"),
    ],
)
def test_a_file_that_is_no_table_is_refused_in_one_line(tmp_path, change, named):
    path = tmp_path / "order.yaml"
    path.write_text(GOOD)
    LearnedTable.load(path)
    path.write_text(GOOD.replace(*change))
    with refused(path, named):
        LearnedTable.load(path)


def test_a_missing_file_is_refused(tmp_path):
    with refused(tmp_path / "nothing.yaml"):
        LearnedTable.load(tmp_path / "nothing.yaml")


@pytest.mark.parametrize("tracker", [path.stem for path in TABLES.glob("*.yaml")])
def test_the_shipped_tables_say_that_the_larger_and_lower_of_two_is_in_front(tracker):
    nearer = np.array([[0.0, -0.1, 0.15, 0.0, 0.0, 0.0]])
    assert shipped_order(tracker).lead(nearer)[0] > 0.2


def test_a_tracker_orders_by_the_table_that_its_settings_name():
    order = make_order(DepthOrderConfig(order="learned", table="contour", remembers_feet=True))
    assert order is shipped_order("contour", remembers_feet=True)
    with refused("nobody.yaml"):
        make_order(DepthOrderConfig(order="learned", table="nobody"))
