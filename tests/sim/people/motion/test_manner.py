import numpy as np
import pytest
from numpy.typing import NDArray

from peopleboy.random_streams import stream
from peopleboy.sim.people.appearance.finisher import Finisher
from peopleboy.sim.people.body.anthropometry import measure
from peopleboy.sim.people.body.body_shapes import sole_points
from peopleboy.sim.people.body.skeleton import (
    BONE_INDEX,
    BONES,
    JOINT_NAMES,
    PARENT_INDEX,
    chain,
    joint_offsets,
    mirror,
)
from peopleboy.sim.people.motion.gait import Gait, amplitude_of, gait_pose, walking_gait
from peopleboy.sim.people.motion.manner import Manner, draw_manner
from peopleboy.sim.people.person import Person
from peopleboy.sim.people.person_config import PersonConfig, Waypoint
from tests.helpers.worlds.individuals import make_individual
from tests.helpers.worlds.person_shapes import person_depth
from tests.helpers.worlds.walkers import make_person, settle, walk

FEET = ("left_foot", "right_foot")
# [m] right wrist, left knee and left ankle 2.5 s after setting off, as they were before manners were known.
PLAIN = ((0.251626, -0.240323, 0.89107), (0.183857, 0.069017, 0.495539), (0.279602, 0.046002, 0.076452))
EMPTY_HANDS = {"carried": "nothing"}


def gait(manner: Manner, stature_m: float = 1.75) -> Gait:
    offsets = joint_offsets(measure(stature_m, "male", "average"))
    return walking_gait(offsets, sole_points(stature_m), stature_m, manner)


def pose(own: Gait, phase: float, amplitude: float) -> NDArray[np.float64]:
    turns = np.empty((len(BONES), 3))
    gait_pose(*own.tables, phase, amplitude, turns)
    return turns


def manners(count: int) -> list[Manner]:
    rng = stream(0, "manners")
    return [draw_manner(rng, None, has_straps=True) for _ in range(count)]


def walking(speed: float) -> dict[str, object]:
    return {"path": (Waypoint(at_m=(0.0, 0.0)), Waypoint(at_m=(40.0, 0.0), speed_m_s=speed))}


def soles(person, seconds: float, start: float, dt: float = 1 / 120) -> np.ndarray:
    """(T, 6, 3) [m] heel, ball and toe of both feet in the world."""
    points = sole_points(person.config.height_m)
    index = [[part.name for part in person.model.parts].index(name) for name in FEET]
    return np.array(
        [
            np.concatenate([points @ f[:3, :3].T + f[:3, 3] for f in person.poses()[index]])
            for _ in walk(person, seconds, dt, start=start)
        ]
    )


def joint(person, name: str) -> np.ndarray:
    return person.joints()[JOINT_NAMES.index(name)]


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("speed", [0.6, 1.3])
def test_feet_on_the_floor_stand_still_in_every_gait(seed: int, speed: float) -> None:
    track = soles(settle(make_individual(seed, **walking(speed)), 3.0), 3.0, start=3.0)
    assert track[..., 2].min(axis=1).min() > -0.01
    assert track[..., 2].min(axis=1).max() < 0.02
    for ball in (1, 4):
        on_floor = track[:, ball, 2] < 0.004
        for first, last in zip(
            *(np.flatnonzero(np.diff(on_floor.astype(int)) == k) for k in (1, -1)), strict=False
        ):
            if last > first + 1:
                assert np.hypot(*np.ptp(track[first + 1 : last + 1, ball, :2], axis=0)) < 0.02


@pytest.mark.parametrize("seed", range(3))
def test_a_stride_times_the_cadence_is_the_speed(seed: int) -> None:
    person = settle(make_individual(seed, height_m=1.75, **walking(1.3)), 3.0)
    heel = soles(person, 6.0, start=3.0)[:, 0, 2]
    strikes = np.flatnonzero((heel[1:] < 0.02) & (heel[:-1] >= 0.02)) / 120
    strikes = strikes[np.diff(strikes, prepend=-1.0) > 0.5]
    own = gait(manner_of(seed, person.config))
    assert own.unit_stride_m * amplitude_of(1.3, own.root_scale) / np.diff(strikes).mean() == pytest.approx(
        1.3, rel=0.02
    )


def manner_of(seed: int, config: PersonConfig) -> Manner:
    return Finisher(config, 21.0, stream(seed, "looks")).manner


def test_steps_and_knees_are_those_of_walking_people() -> None:
    steps, knees = [], []
    for manner in manners(12):
        own = gait(manner)
        amplitude = amplitude_of(1.3, own.root_scale)
        turns = [pose(own, phase, amplitude)[BONE_INDEX["left_shin"]] for phase in np.linspace(0, 1, 48)]
        steps.append(own.unit_stride_m * amplitude / 2.0 / 1.75)
        knees.append(np.degrees(np.linalg.norm(turns, axis=1).max()))
    assert np.mean(steps) == pytest.approx(0.41, abs=0.02)
    assert np.std(steps) > 0.01
    assert 55.0 < np.min(knees) < np.max(knees) < 80.0


def test_both_sides_do_the_same_half_a_cycle_apart() -> None:
    own = gait(
        Manner(stride=1.1, arm_swing=1.4, arm_spread=0.8, arms_off_rad=0.1, elbow_rad=0.3, stoop_rad=0.1)
    )
    for phase in np.linspace(0.0, 1.0, 9):
        np.testing.assert_allclose(pose(own, phase, 1.0), mirror(pose(own, phase + 0.5, 1.0)), atol=0.03)


def test_arms_hang_away_from_the_trunk_and_feet_apart() -> None:
    def widths(person) -> list[float]:
        return [
            np.ptp([joint(person, f"{side}_{name}")[1] for side in ("left", "right")])
            for name in ("wrist", "ankle")
        ]

    usual = widths(make_person(height_m=1.75))
    free = {"holds": ("free", "free")}
    own = [widths(make_individual(s, height_m=1.75, manner=free, outfit=EMPTY_HANDS)) for s in range(10)]
    assert np.mean(own, axis=0) == pytest.approx([usual[0] + 0.12, usual[1] + 0.06], abs=0.06)
    assert np.std(own, axis=0).min() > 0.015


def test_arms_swing_by_their_own_amplitude() -> None:
    def swing(factor: float) -> float:
        own = gait(Manner(arm_swing=factor))
        offsets = joint_offsets(measure(1.75, "male", "average"))
        hand = [
            chain(pose(own, p, 1.0), offsets, PARENT_INDEX)[BONE_INDEX["left_hand"], 0, 3]
            for p in np.linspace(0, 1, 24)
        ]
        return float(np.ptp(hand))

    assert swing(0.4) < 0.6 * swing(1.0)
    assert swing(1.5) > 1.3 * swing(1.0)


@pytest.mark.parametrize("seconds", [0.2, 3.0])
def test_hands_are_where_they_hold_something(seconds: float) -> None:
    def person(*holds: str):
        return settle(make_individual(2, manner={"holds": holds, "leans": 0.0}, **walking(1.2)), seconds)

    calls, idle = person("free", "telephone"), person("pocket", "in_front")
    assert np.linalg.norm(calls.palm("right") - joint(calls, "right_ear")) < 0.2
    assert np.linalg.norm(idle.palm("left") - joint(idle, "left_hip")) < 0.25
    front = idle.palm("right")[:2] - idle.position
    assert 0.12 < front @ [np.cos(idle.heading), np.sin(idle.heading)] < 0.45


def test_crossed_arms_let_go_of_everything() -> None:
    free, held = (
        make_individual(1, arms="crossed", manner={"holds": (hold, hold)}, outfit=EMPTY_HANDS).joints()
        for hold in ("free", "pocket")
    )
    np.testing.assert_allclose(free, held, atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_every_joint_of_every_individual_lies_inside_its_shapes(seed: int) -> None:
    person = settle(make_individual(seed, **walking(1.2)), 1.3)
    assert (person_depth(person, person.joints()) > 0.0).all()


def test_people_of_plain_detail_walk_as_they_always_did() -> None:
    person = settle(make_person(height_m=1.75, **walking(1.2)), 2.5, dt=1 / 60)
    shown = [
        joint(person, name) - [*person.position, 0.0] for name in ("right_wrist", "left_knee", "left_ankle")
    ]
    np.testing.assert_allclose(shown, PLAIN, atol=1e-6)


def slid_m(person: Person) -> float:
    """How far balls of feet that touch the floor slide in all, on a way with starts, stops and a turn."""
    track = soles(person, 8.0, start=0.0, dt=1 / 60)[:, [1, 4]]
    on_floor = (track[1:, :, 2] < 0.004) & (track[:-1, :, 2] < 0.004)
    return float(np.linalg.norm(np.diff(track[..., :2], axis=0), axis=-1)[on_floor].sum())


@pytest.mark.slow
def test_feet_slide_hardly_farther_than_in_plain_detail_where_people_start_turn_and_stop() -> None:
    ways = [
        (
            Waypoint(at_m=(0.0, 0.0), pause_s=1.0),
            Waypoint(at_m=middle, pause_s=0.5),
            Waypoint(at_m=end, pause_s=1.0),
        )
        for middle, end in (((3.0, 0.0), (3.0, 2.0)), ((2.0, 0.0), (4.0, 0.0)))
    ]
    plain, own = (
        np.mean([slid_m(make(seed, path=way)) for way in ways for seed in range(6)])
        for make in (make_person, make_individual)
    )
    assert own < 1.1 * plain
