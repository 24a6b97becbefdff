from peopleboy.scenarios.run_folder.run_tables import COLUMNS, TRACKS, explained, read_explanation, track_rows
from peopleboy.tracker.tracking.sensor import SensorExplanations
from tests.helpers.runs import synthetic_ticks as made


def test_contours_are_read_back_as_they_were_written() -> None:
    tick = made.make_tick(10)
    again = read_explanation("contour", track_rows(tick))
    assert again is not None
    assert (again.config, again.ellipses, again.spread_px2) == (
        tick.explanation.config, tick.explanation.ellipses, tick.explanation.spread_px2
    )  # fmt: skip


def test_a_tracker_that_explains_nothing_leaves_its_columns_without_values() -> None:
    assert set(COLUMNS) < set(TRACKS.names)
    row = dict(explained(None, 1))
    assert row == dict.fromkeys(COLUMNS)
    assert read_explanation("contour", [{"id": 1, **row}]) is None


def test_contours_of_a_tracker_that_is_not_ours_are_not_made_up() -> None:
    assert read_explanation("truth", track_rows(made.make_tick(10))) is None


def test_of_the_handover_who_has_a_contour_has_values_under_its_shared_number() -> None:
    contours = made.make_tick(10).explanation
    both = SensorExplanations((contours.renumbered({1: 6}), None))
    assert explained(both, 6) == explained(contours, 1)
    assert explained(both, 1) == dict.fromkeys(COLUMNS)
