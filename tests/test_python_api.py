"""What a user's first scripts do, with the public names alone."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path

import gymnasium
import numpy as np
import pytest

import peopleboy
from peopleboy import (
    BadInput,
    Frame,
    Observation,
    Status,
    Track,
    TrackBoxes,
    World,
    closed_loop,
    evaluate,
    evaluate_run,
    film,
    load_scenario,
    make_tracker,
    run,
)
from peopleboy.registration import ENVIRONMENTS, MAX_EPISODE_STEPS
from peopleboy.tracker.trackers import TRACKERS
from tests.helpers.calls.refused import refused
from tests.helpers.import_graph import ROOT

PNG = b"\x89PNG"


class Standing:
    """One confirmed and one tentative track, always at the same place."""

    cameras = ("thermal",)

    def __init__(self, rng: np.random.Generator) -> None:
        del rng

    def update(self, frame: Frame) -> tuple[Track, ...]:
        box = {"thermal": (10.0, 20.0, 30.0, 90.0)}
        sure = Track(id=1, boxes=box, confidence=0.9, status=Status.TRACKED, age_s=frame.time_s)
        return sure, Track(id=2, boxes=box, confidence=0.1, status=Status.TENTATIVE, age_s=0.0)


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    with World("crossing_2", seed=3, cameras=("depth",)) as made:
        yield made


@pytest.fixture(scope="module")
def observation(world: World) -> Observation:
    return world.observe()


def test_the_first_loop_needs_nothing_but_public_names(world: World, observation: Observation) -> None:
    frame = Frame.from_observation(observation)
    assert set(frame.calibrations) >= {"thermal", "colour", "depth"}
    assert frame.odometry is None
    assert isinstance(make_tracker("detection", seed=1).update(frame), tuple)
    moved = Frame.from_observation(observation, observation.odometry)
    assert moved.odometry is not None
    assert moved.odometry.advance_m == 0.0
    assert world.config.seed == 3


def test_a_name_is_accepted_wherever_a_scenario_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    short = load_scenario("empty_room").lasting(0.2)
    assert load_scenario(short) is short
    with refused("unknown scenario 'crossing_22'", "did you mean 'crossing_2'"):
        World("crossing_22")
    with refused("seed"), World("empty_room") as there:
        World(there.config, seed=3)
    with refused("unknown scenario"):
        run("no_such_scenario_at_all")
    with refused("unknown scenario"):
        film("no_such_scenario_at_all", 0, tmp_path)
    run(short)
    assert (tmp_path / "runs" / "empty_room-0" / "metrics.json").is_file()
    with World(short) as there:
        ticks = list(closed_loop(there, "thermal", "stand", 2))
    assert [tick.frame for tick in ticks] == [1, 2]


def test_a_tracker_is_made_by_name_and_seed() -> None:
    assert make_tracker("contour").cameras == make_tracker("contour", np.int64(4)).cameras
    for wrong in (-1, 0.5, np.random.default_rng(0)):
        with refused("seed must be a whole number"):
            make_tracker("contour", wrong)


@pytest.mark.parametrize("name", TRACKERS.shipped)
def test_a_bare_image_is_refused_with_what_to_write(name: str) -> None:
    with refused("takes a Frame, got ndarray (240, 320) uint8", "Frame.from_image"):
        make_tracker(name).update(np.zeros((240, 320), np.uint8))


def test_a_bare_image_is_a_frame_in_one_call() -> None:
    frame = Frame.from_image(np.full((240, 320), 90, np.uint8), time_s=0.0)
    assert make_tracker("detection").update(frame) == ()


def test_boxes_are_taken_from_confirmed_tracks() -> None:
    tracker = Standing(np.random.default_rng(0))
    frames = [Frame.from_image(np.zeros((240, 320), np.uint8), k / 15.0) for k in range(3)]
    boxes = TrackBoxes.from_tracks(tracker.update(frame) for frame in frames)
    assert boxes.frame.tolist() == [1, 2, 3]
    assert set(boxes.id.tolist()) == {1}
    assert boxes.box[0].tolist() == [10.0, 20.0, 30.0, 90.0]
    assert repr(boxes) == "TrackBoxes(3 boxes, 1 ids, last frame 3)"
    assert len(TrackBoxes.from_tracks([(), ()])) == 0


def test_a_tracker_is_run_and_scored_in_one_call() -> None:
    scenario = load_scenario("crossing_2").lasting(0.4)
    scores = evaluate_run(scenario, Standing, seeds=(0, 1), boxes="whole")
    assert scores.counts.frames == 12
    assert scores.counts.candidates == 12
    assert repr(scores).startswith("Scores(12 frames: HOTA")
    with refused("at least one"):
        evaluate_run(scenario, seeds=())


def test_the_version_is_that_of_the_package() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert peopleboy.__version__ == project["version"]
    assert "__version__" in dir(peopleboy)


def test_reprs_are_short(world: World, observation: Observation) -> None:
    truth = world.truth()
    scenario = load_scenario("crossing_2")
    assert repr(scenario).startswith("Scenario('crossing_2', ")
    assert re.fullmatch(r"PersonTruth\(1 '\w+', [\d.]+ m, \d+% visible\)", repr(truth.people[0]))
    shown = [scenario, truth, observation, Frame.from_observation(observation)]
    shown += Standing(np.random.default_rng(0)).update(shown[-1])
    for thing in shown:
        assert len(repr(thing)) < 400
        assert "array(" not in repr(thing)


def test_notebooks_get_pictures(observation: Observation) -> None:
    shown = (load_scenario("empty_room"), observation, Frame.from_observation(observation))
    for thing in shown:
        assert thing._repr_png_().startswith(PNG)
    assert Frame(images={}, time_s=0.0)._repr_png_() is None


def test_returned_types_can_be_annotated() -> None:
    for name in (
        "Scenario",
        "WorldConfig",
        "Observation",
        "Truth",
        "Tick",
        "Film",
        "RunScores",
        "FloorPlace",
    ):
        assert hasattr(peopleboy, name)
    assert evaluate.__annotations__["return"] is peopleboy.Scores


@pytest.mark.parametrize("name", ENVIRONMENTS)
def test_the_environments_say_how_long_episodes_are(name: str) -> None:
    scenario = load_scenario(ENVIRONMENTS[name]["scenario"])
    assert gymnasium.spec(name).max_episode_steps == MAX_EPISODE_STEPS == round(15 * scenario.duration_s)


def test_a_limit_on_the_steps_ends_episodes_of_one_and_of_many_worlds() -> None:
    settings = {"observation": "truth", "physics": "kinematic", "max_episode_steps": 2}
    one = gymnasium.make("peopleboy/PersonFollowing-v0", **settings)
    many = gymnasium.make_vec(
        "peopleboy/PersonFollowing-v0", 1, vectorization_mode="vector_entry_point", **settings
    )
    one.reset(seed=0)
    many.reset(seed=0)
    ends = [one.step(np.zeros(2, np.float32))[3] for _ in range(2)]
    assert ends == [bool(many.step(np.zeros((1, 2), np.float32))[3][0]) for _ in range(2)] == [False, True]
    with pytest.raises(BadInput, match="max_episode_steps"):
        peopleboy.PeopleBoyEnv(max_episode_steps=0)
    one.close()
    many.close()
