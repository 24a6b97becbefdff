import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from peopleboy.scenarios.scores.bootstrap import compare_pairs
from peopleboy.scenarios.scores.summaries import summarise
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.table import parse_figures
from tests.helpers.calls.refused import refused
from tests.helpers.images.random_sequences import tracks_of, truth_of

PERSON = (0, 0, 20, 60)


def found(count: int) -> Scores:
    """One person who is found in so many of ten frames."""
    truth = truth_of([(frame, 1, *PERSON) for frame in range(1, 11)])
    return evaluate(truth, tracks_of([(frame, 1, *PERSON) for frame in range(1, count + 1)]))


def test_a_summary_leaves_out_runs_in_which_a_metric_is_undefined() -> None:
    recall, precision = summarise([found(10), found(0)], parse_figures("CR, CP"))
    assert (recall.mean, recall.runs, recall.whole) == (50.0, 2, 50.0)
    assert recall.sd == pytest.approx(math.sqrt(2 * 50.0**2))
    assert (precision.mean, precision.runs) == (100.0, 1)
    assert math.isnan(precision.sd)
    assert not precision.interval.is_known


def test_an_interval_does_not_depend_on_the_other_metrics() -> None:
    runs = [found(count) for count in (3, 5, 9)]
    (alone,) = summarise(runs, parse_figures("HOTA"))
    among = {one.figure.name: one for one in summarise(runs)}
    assert among["HOTA"].interval == alone.interval
    values = [one.mot.hota.hota for one in runs]
    assert min(values) <= alone.interval.low < alone.mean < alone.interval.high <= max(values)


def wilcoxon(values: np.ndarray) -> float:
    """Compute the two-sided p of the signed-rank test by listing all signs."""
    rank = stats.rankdata(np.abs(values))
    observed = abs(float((np.sign(values) * rank).sum()))
    sums = [abs(float((np.array(signs) * rank).sum())) for signs in product((-1, 1), repeat=len(values))]
    return float(np.mean([one >= observed - 1e-9 for one in sums]))


@given(st.lists(st.integers(1, 10**6), min_size=2, max_size=8, unique=True), st.integers(0, 255))
def test_p_is_the_share_of_signs_that_give_as_large_a_sum_of_ranks(sizes: list[int], signs: int) -> None:
    values = np.array([size if signs >> k & 1 else -size for k, size in enumerate(sizes)], float)
    assert compare_pairs(values.tolist()).p == pytest.approx(wilcoxon(values))


def test_equal_trackers_have_p_1_and_a_single_pair_has_none() -> None:
    assert compare_pairs([0.0, 0.0, 0.0]).p == 1.0
    assert math.isnan(compare_pairs([3.0]).p)
    assert math.isnan(compare_pairs([3.0, math.nan]).p)


def test_metrics_are_chosen_by_name_and_unknown_ones_refused() -> None:
    chosen = parse_figures("hota,IDSW, 95 % error")
    assert [figure.name for figure in chosen] == ["HOTA", "IDSW", "95 % error"]
    with refused("unknown metric 'HOTTA'", "did you mean 'HOTA'"):
        parse_figures("HOTTA")
    with refused("'HOTA'", "twice"):
        parse_figures("HOTA,hota")
