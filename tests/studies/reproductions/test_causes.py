from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.suite import SuiteRun
from peopleboy.studies.reproductions.experiments.experiment import Line
from peopleboy.studies.reproductions.experiments.shortfalls import BOXES, PEOPLE, Causes
from peopleboy.studies.reproductions.measuring.cause_units import (
    FAR,
    FOUND,
    HALF,
    NEAR,
    RANGE,
    STRETCH,
    STRICT,
    WAYS,
    CauseUnit,
    not_yet_found,
    ways_to_count,
)
from peopleboy.studies.reproductions.measuring.tracker_settings import Setting
from peopleboy.studies.reproductions.measuring.units import TrackUnit
from peopleboy.studies.reproductions.measuring.workload import Plan
from peopleboy.tracker.evaluation.evaluate import evaluate
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes

PLAY = SuiteRun(load_scenario("passers_by").lasting(5.0), 100)
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
    ways = ways_to_count(truth, distance_m, found)
    assert tuple(ways) == WAYS
    precisions = {way: evaluate(one, found, frames=2).paper.ocp for way, one in ways.items()}
    assert precisions[STRICT] == pytest.approx(100 * 2 / 5)
    assert precisions[NEAR] == pytest.approx(100 * 2 / 4)
    assert precisions[FAR] == pytest.approx(100 * 2 / 3)
    assert precisions[RANGE] == precisions[""] == precisions[HALF] == 100.0
    assert {way: int(one.counted.sum()) for way, one in ways.items()} == dict.fromkeys(WAYS, 4) | {HALF: 2}


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
    assert ways_to_count(truth, np.tile(DISTANCE_M, 6), found)[FOUND].counted.sum() == 4


@pytest.mark.slow
def test_usual_and_strict_figures_are_those_of_the_other_parts(tmp_path: Path) -> None:
    setting, plan = Setting("contour"), Plan(cache=tmp_path, suites={"dataset1": (PLAY,)}, repeats=1)
    experiment = Causes("default", setting, {"one person": ("dataset1",)})
    done: dict[str, dict[str, object]] = {}
    while wanted := experiment.wants(plan, done):
        done |= {unit.key: unit.run() for unit in wanted}
    causes, usual = CauseUnit(PLAY, tmp_path, setting, 0), TrackUnit(PLAY, tmp_path, setting, 0).run()
    for way, rule in (("", "ignore"), (STRICT, "absent"), (HALF, "half in view")):
        assert {name: done[causes.key][way][name] for name in ("paper", "thesis")} == {
            name: usual[rule][name] for name in ("paper", "thesis")
        }
    samples = experiment.samples(plan, done)
    assert samples[Line("one person", f"default, {STRICT}")][BOXES].tolist() == [0.0]
    assert 0.0 < samples[Line("one person", f"default, {FOUND}")][PEOPLE][0] < 100.0
