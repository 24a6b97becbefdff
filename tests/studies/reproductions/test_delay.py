from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.suite import SuiteRun
from peopleboy.scenarios.running.frame_cache import film
from peopleboy.studies.reproductions.experiments.experiment import Line
from peopleboy.studies.reproductions.experiments.shortfalls import Delay
from peopleboy.studies.reproductions.measuring.delay_units import (
    EVERY,
    PATIENCE,
    DelayUnit,
    plain_starts,
)
from peopleboy.studies.reproductions.measuring.tracker_settings import Setting
from peopleboy.studies.reproductions.measuring.workload import Plan
from peopleboy.tracker.evaluation.sequence import TrueBoxes
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.track import Status, Track
from peopleboy.tracker.trackers import Tracker

PLAY = SuiteRun(load_scenario("single_stationary").lasting(9.0), 0)


def truth_of(frames: list[int], visible: float = 1.0, *, counted: bool = True, person: int = 1) -> TrueBoxes:
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
    assert list(plain_starts(truth_of(frames))) == [5, 5 + EVERY]
    assert list(plain_starts(truth_of(frames, visible=0.8))) == []
    assert list(plain_starts(truth_of(frames, counted=False))) == []


def test_nobody_is_to_be_found_while_there_are_two() -> None:
    one, other = truth_of([*range(1, 41)]), truth_of([10, 11], 0.2, counted=False, person=2)
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
class LateSetting(Setting):
    """Makes trackers that know the truth, from the third frame on."""

    films: Path = Path()

    def make(self, rng: np.random.Generator) -> Tracker:
        del rng  # nothing is left to chance
        return Late(film(PLAY.scenario, PLAY.seed, self.films).truth())


@pytest.fixture(scope="module")
def films(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("films")


@pytest.mark.slow
def test_frames_are_counted_from_the_start_to_the_first_that_is_claimed(films: Path) -> None:
    result = DelayUnit(PLAY, films, LateSetting("late", films=films), 0).run()
    assert result["starts"] >= 3
    assert result["needed"] == [3] * result["starts"]


def test_means_are_over_all_starts_and_the_blind_find_nobody(films: Path) -> None:
    late, blind = (
        LateSetting("late", films=films),
        Setting("contour", (("life.birth_frames", 99), ("search.clear_frames", 99))),
    )
    plan = Plan(cache=films, suites={"dataset1": (PLAY,)}, repeats=2)
    experiment = Delay(("dataset1",), {"late": late, "blind": blind})
    done: dict[str, dict[str, object]] = {}
    while wanted := experiment.wants(plan, done):
        done |= {unit.key: unit.run() for unit in wanted}
    samples = experiment.samples(plan, done)
    figures = samples[Line("dataset1", "late")]
    assert figures["frames"].tolist() == [3.0, 3.0]
    assert figures["s"].tolist() == [0.2, 0.2]
    assert figures["found in 2 s [%]"].tolist() == [100.0, 100.0]
    nobody = samples[Line("dataset1", "blind")]
    assert np.isnan(nobody["frames"]).all()
    assert nobody["found in 2 s [%]"].tolist() == [0.0, 0.0]
