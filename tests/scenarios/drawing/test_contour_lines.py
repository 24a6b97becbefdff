from peopleboy.scenarios.drawing.contour_lines import lines_of
from peopleboy.tracker.fusion.explanations import BothExplanations
from tests.helpers.runs import synthetic_ticks as made


def test_contours_of_the_handover_are_drawn_under_the_shared_numbers() -> None:
    contours = made.explain()
    both = lines_of(BothExplanations.of(contours, None, {1: 8}), 24)
    assert list(both) == [8]
    for one, other in zip(both[8], lines_of(contours, 24)[1], strict=True):
        assert one.shape[1] == 2
        assert (one == other).all()


def test_of_other_explanations_nothing_is_drawn() -> None:
    assert lines_of(None) == lines_of(object()) == {}
