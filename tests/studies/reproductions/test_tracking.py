from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from peopleboy.geometry.camera_calibration import PinholeCalibration
from peopleboy.random_streams import stream
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.suite import SuiteRun
from peopleboy.scenarios.running.engine.store import Result
from peopleboy.scenarios.running.frame_cache import Film, film
from peopleboy.studies.reproductions.experiment import Line, Samples
from peopleboy.studies.reproductions.experiments import sequence_scores
from peopleboy.studies.reproductions.experiments.sequence_scores import (
    EVERY,
    FAR,
    FOUND,
    HALF,
    NEAR,
    PATIENCE,
    RANGE,
    RECORDS,
    STRETCH,
    STRICT,
    USUAL,
    measure_delay,
    not_yet_found,
    plain_starts,
    track_sequence,
    truth_by_way,
)
from peopleboy.studies.reproductions.experiments.tracking import (
    BOXES,
    PEOPLE,
    RULES,
    count_unit,
    delay,
    restored,
    sequence_unit,
    tracking,
)
from peopleboy.studies.reproductions.plan import Plan
from peopleboy.studies.reproductions.tracker_settings import TrackerSetting
from peopleboy.studies.reproductions.units import Measurement, Unfinished
from peopleboy.tracker.evaluation.area_metrics import PaperMetrics, ThesisMetrics
from peopleboy.tracker.evaluation.evaluate import evaluate
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.track import FloorPlace, Status, Track
from peopleboy.tracker.trackers import Tracker


def measured(measure: Callable[[Measurement], Samples], plan: Plan) -> tuple[Samples, dict[str, Result]]:
    """Run all units that a measurement asks for, and give its lines and the results."""
    done: dict[str, Result] = {}
    while True:
        try:
            return measure(Measurement(plan, done)), done
        except Unfinished as unfinished:
            done |= {unit.key: unit.run() for unit in unfinished.units}


def test_a_unit_gives_the_same_result_again_and_its_sums_come_back(tmp_path: Path) -> None:
    play = SuiteRun(load_scenario("crossing_pair").lasting(1.0), 0)
    unit = sequence_unit(play, tmp_path, TrackerSetting("contour"), 1)
    one = unit.run()
    assert one == unit.run()
    restored_paper = restored(PaperMetrics, one[USUAL]["paper"])
    assert restored_paper.areas.targets == one[USUAL]["counts"]["targets"] > 0
    assert set(RECORDS) == set(one[STRICT])


@pytest.mark.slow
def test_noise_of_labels_lowers_areas_and_without_it_nothing_changes(tmp_path: Path) -> None:
    play, setting = SuiteRun(load_scenario("crossing_pair").lasting(3.0), 0), TrackerSetting("contour")
    plain, unnoisy, noisy, again = (
        sequence_unit(play, tmp_path, setting, 0, **noise)
        for noise in ({}, {"label_noise_px": 0.0}, {"label_noise_px": 4.0}, {"label_noise_px": 4.0})
    )
    assert plain.key == unnoisy.key != noisy.key
    exact, labelled = unnoisy.run(), noisy.run()
    assert exact == plain.run()
    assert labelled == again.run()
    areas = [restored(ThesisMetrics, one[USUAL]["thesis"]) for one in (exact, labelled)]
    assert areas[0].ar > areas[1].ar
    assert areas[0].ap > areas[1].ap


CAMERA_X_M = 0.5
CAMERA = np.eye(4)
CAMERA[0, 3] = CAMERA_X_M
FRAME = Frame(
    images={THERMAL: np.zeros((24, 32), np.uint8)},
    calibrations={THERMAL: PinholeCalibration(np.diag([30.0, 30.0, 1.0]), CAMERA)},
    time_s=0.0,
)


class Told:
    """Sees people straight ahead, as far from the camera as it was told, or at no known place."""

    cameras = (THERMAL,)

    def __init__(self, *distances_m: float | None) -> None:
        self.distances_m = distances_m

    def update(self, frame: Frame) -> tuple[Track, ...]:  # noqa: ARG002
        return tuple(
            Track(
                id=number,
                boxes={THERMAL: (0.0, 0.0, 5.0, 15.0)},
                place=None
                if away is None
                else FloorPlace(position_m=(away + CAMERA_X_M, 0.0), covariance_m2=(1, 0, 1)),
                confidence=1.0,
                status=Status.TRACKED,
                age_s=1.0,
            )
            for number, away in enumerate(self.distances_m, 1)
        )


def test_people_are_in_range_from_3_to_10_m_from_the_camera_or_at_no_known_place(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(sequence_scores, "frames_of", lambda _film, _cameras: iter([FRAME]))
    film = Film(Path("nowhere"), "made_up", 0, 1, {}, {})
    found, is_in_range = track_sequence(film, Told(2.9, 3.1, 9.9, 10.1, None))
    assert found.id.tolist() == [1, 2, 3, 4, 5]
    assert is_in_range.tolist() == [False, True, True, False, True]


STANDING = SuiteRun(load_scenario("single_stationary").lasting(9.0), 0)


def plain_truth(
    frames: list[int], visible: float = 1.0, *, counted: bool = True, person: int = 1
) -> TrueBoxes:
    count = len(frames)
    return TrueBoxes(
        frame=np.array(frames),
        id=np.full(count, person),
        box=np.tile([10.0, 10.0, 20.0, 60.0], (count, 1)),
        counted=np.full(count, counted),
        visible=np.full(count, visible),
    )


def test_starts_are_where_one_person_stays_in_plain_view_for_long_enough() -> None:
    frames = [*range(5, 5 + PATIENCE + EVERY), *range(200, 200 + PATIENCE - 1)]
    assert list(plain_starts(plain_truth(frames))) == [5, 5 + EVERY]
    assert list(plain_starts(plain_truth(frames, visible=0.8))) == []
    assert list(plain_starts(plain_truth(frames, counted=False))) == []


def test_nobody_is_to_be_found_while_there_are_two() -> None:
    one, other = plain_truth([*range(1, 41)]), plain_truth([10, 11], 0.2, counted=False, person=2)
    columns = ("frame", "id", "box", "counted", "visible")
    both = {name: np.concatenate([getattr(one, name), getattr(other, name)]) for name in columns}
    assert list(plain_starts(one)) == [1]
    assert list(plain_starts(TrueBoxes(**both))) == []


@dataclass
class Late:
    """Knows the truth, and tells it in the third frame that it sees; before, it is only tentative."""

    truth: TrueBoxes
    seen: list[Frame] = field(default_factory=list)

    def update(self, frame: Frame) -> tuple[Track, ...]:
        self.seen.append(frame)
        number = round(frame.time_s * 15)
        [box] = self.truth.box[self.truth.frame == number]
        status = Status.TRACKED if len(self.seen) >= 3 else Status.TENTATIVE
        left, top, width, height = (float(value) for value in box)
        track = Track(
            id=1,
            boxes={"thermal": (left, top, width, height)},
            confidence=1.0,
            status=status,
            age_s=0.0,
        )
        return (track,)

    @property
    def cameras(self) -> tuple[str, ...]:
        return ("thermal",)


@dataclass(frozen=True, slots=True)
class LateSetting(TrackerSetting):
    """Makes trackers that know the truth, from the third frame on."""

    films: Path = Path()

    def make(self, rng: np.random.Generator) -> Tracker:
        del rng  # nothing is left to chance
        return Late(film(STANDING.scenario, STANDING.seed, self.films).truth())


@pytest.fixture(scope="module")
def films(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("films")


@pytest.mark.slow
def test_frames_are_counted_from_the_start_to_the_first_that_is_claimed(films: Path) -> None:
    result = measure_delay(STANDING, films, LateSetting("late", films=films), 0)
    assert result["starts"] >= 3
    assert result["needed"] == [3] * result["starts"]


@pytest.mark.slow
def test_a_blind_tracker_finds_nobody(films: Path) -> None:
    blind = TrackerSetting("contour", (("life.birth_frames", 99), ("search.clear_frames", 99)))
    result = measure_delay(STANDING, films, blind, 0)
    assert result["starts"] >= 3
    assert result["needed"] == []


def test_means_are_over_all_starts() -> None:
    plan = Plan(cache=Path("films"), suites={"dataset1": (STANDING,)}, repeats=2)
    trackers = {"late": "contour", "blind": "contour-thermal"}
    done = {count_unit(STANDING, plan.cache).key: Result()}
    for base, needed in (("contour", [3, 3, 3]), ("contour-thermal", [])):
        for repeat in range(2):
            unit = sequence_unit(STANDING, plan.cache, TrackerSetting(base), repeat, measure_delay)
            done[unit.key] = {"starts": 3, "needed": needed}
    samples = delay(Measurement(plan, done), groups={"dataset1": {"suites": ["dataset1"]}}, trackers=trackers)
    values = samples[Line("dataset1", "late")]
    assert [np.asarray(values[name]).tolist() for name in ("frames", "s")] == [[3.0, 3.0], [0.2, 0.2]]
    assert np.asarray(values["found in 2 s [%]"]).tolist() == [100.0, 100.0]
    nobody = samples[Line("dataset1", "blind")]
    assert np.isnan(np.asarray(nobody["frames"])).all()
    assert np.asarray(nobody["found in 2 s [%]"]).tolist() == [0.0, 0.0]


PASSING = SuiteRun(load_scenario("passers_by").lasting(5.0), 100)
DISTANCE_M = (2.0, 5.0, 6.0, 14.0, 15.0)  # of five people, the third of whom is less than half in view


def truth_of(frames: list[int]) -> TrueBoxes:
    """Five people beside each other in each of these frames."""
    people = len(DISTANCE_M)
    return TrueBoxes(
        frame=np.repeat(frames, people),
        id=np.tile(np.arange(1, people + 1), len(frames)),
        box=np.array([[100.0 * person, 10.0, 20.0, 60.0] for _ in frames for person in range(people)]),
        counted=np.tile([False, True, True, False, False], len(frames)),
        visible=np.tile([1.0, 1.0, 0.3, 1.0, 1.0], len(frames)),
    )


def found_at(truth: TrueBoxes) -> TrackBoxes:
    """Tracks that are on all of these people."""
    return TrackBoxes(frame=truth.frame, id=truth.id, box=truth.box, confidence=np.ones(len(truth)))


def test_each_way_sets_aside_what_its_name_says() -> None:
    truth = truth_of([1, 2])
    distance_m, found = np.tile(DISTANCE_M, 2), found_at(truth)
    ways = truth_by_way(truth, distance_m, found)
    precisions = {way: evaluate(one, found, frames=2).paper.ocp for way, one in ways.items()}
    assert precisions[STRICT] == pytest.approx(100 * 2 / 5)
    assert precisions[NEAR] == pytest.approx(100 * 2 / 4)
    assert precisions[FAR] == pytest.approx(100 * 2 / 3)
    assert precisions[RANGE] == precisions[USUAL] == precisions[HALF] == 100.0
    assert {way: int(one.counted.sum()) for way, one in ways.items()} == dict.fromkeys(ways, 4) | {HALF: 2}


def test_every_way_to_count_that_is_declared_is_scored() -> None:
    truth = truth_of([1])
    ways = truth_by_way(truth, np.array(DISTANCE_M), found_at(truth))
    assert {way for rules in RULES.values() for way in rules} == set(ways)


def test_who_comes_anew_has_yet_to_be_found() -> None:
    early, late = [1, 2, 3, 4], [4 + STRETCH, 5 + STRETCH]
    truth = truth_of([*early, *late])
    is_second = truth.id == 2
    found = found_at(truth.take(is_second & np.isin(truth.frame, [3])))
    waits = not_yet_found(truth, found)
    assert truth.frame[waits & is_second].tolist() == [1, 2]
    assert (waits & (truth.id == 3)).sum() == len([*early, *late])
    later = replace(truth, frame=np.where(truth.frame > 4, truth.frame + 1, truth.frame))
    assert later.frame[not_yet_found(later, found) & is_second].tolist() == [1, 2, 5 + STRETCH, 6 + STRETCH]
    assert not not_yet_found(truth, found)[~truth.counted].any()
    assert truth_by_way(truth, np.tile(DISTANCE_M, 6), found)[FOUND].counted.sum() == 4


@pytest.mark.slow
def test_usual_and_strict_figures_are_those_of_the_evaluation(tmp_path: Path) -> None:
    setting, plan = (
        TrackerSetting("contour"),
        Plan(cache=tmp_path, suites={"dataset1": (PASSING,)}, repeats=1),
    )
    declared = {"trackers": {"default": "contour"}, "groups": {"one person": {"suites": ["dataset1"]}}}
    measure = partial(tracking, metrics=[BOXES, PEOPLE], rules="causes", **declared)
    samples, done = measured(measure, plan)
    found = done[sequence_unit(PASSING, tmp_path, setting, 0).key]
    shot = film(PASSING.scenario, PASSING.seed, tmp_path)
    tracks, _ = track_sequence(shot, setting.make(stream(0, "reproduce.tracker")))
    for way, rule, visible in ((USUAL, "ignore", 0.0), (STRICT, "absent", 0.0), (HALF, "ignore", 0.5)):
        rules: dict[str, Any] = {"uncounted": rule, "min_visible": visible}
        scores = evaluate(shot.truth(), tracks, frames=shot.frames, **rules)
        assert found[way]["paper"] == asdict(scores.paper)
        assert found[way]["thesis"] == asdict(scores.thesis)
    assert np.asarray(samples[Line("one person", f"default, {STRICT}")][BOXES]).tolist() == [0.0]
    assert 0.0 < np.asarray(samples[Line("one person", f"default, {FOUND}")][PEOPLE])[0] < 100.0
