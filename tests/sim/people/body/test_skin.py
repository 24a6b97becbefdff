"""Bodies with skins: their choice, clothes and feet."""

from itertools import pairwise

import numpy as np
import pytest

from peopleboy.sim.people.body.bodies import RestBody, choose_body
from peopleboy.sim.people.body.body_shapes import BODY_PARTS
from peopleboy.sim.people.body.clothes import Clothes
from peopleboy.sim.people.body.skeleton import BONE_INDEX
from peopleboy.sim.people.person import Person
from peopleboy.sim.people.person_config import PersonConfig, Waypoint
from peopleboy.sim.shapes.shape_table import make_shape_table
from peopleboy.sim.shapes.skins import join_skins, pose_skins
from tests.helpers.worlds.walkers import settle, walk

AGES = ("child", "adult", "elder")
STATURES_M = {"child": 1.15, "adult": 1.8, "elder": 1.6}


def body(age: str, sex: str = "male", build: str = "average", seed: int = 0) -> RestBody:
    return choose_body(age, sex, build, STATURES_M[age], np.random.default_rng(seed))


def skinned(age: str, speed: float = 1.0) -> Person:
    path = (Waypoint(at_m=(0.0, 0.0)), Waypoint(at_m=(40.0, 0.0), speed_m_s=speed))
    config = PersonConfig(name="ann", path=path, age=age, height_m=STATURES_M[age])
    return Person(config, np.random.default_rng(0), body=body(age))


def vertices(person: Person) -> np.ndarray:
    """(V, 3) [m] of a person's skin, world frame."""
    assert person.model.skin is not None
    _, table = join_skins(make_shape_table([]), [(person.model.skin, range(len(person.model.parts)))])
    assert table is not None
    return pose_skins(table, person.poses()).vertices


def depth(one: RestBody) -> float:
    """[m] depth of the trunk at the waist, of a body scaled to 1 m."""
    label = one.mesh.labels.index("abdomen")
    belly = one.vertices[np.unique(one.mesh.triangles[one.mesh.label == label])]
    return float(np.ptp(belly[:, 0]) / one.vertices[:, 2].max())


@pytest.mark.parametrize("age", AGES)
def test_a_body_has_the_stature_of_its_person(age: str) -> None:
    one = body(age)
    assert one.vertices[:, 2].min() == pytest.approx(0.0, abs=1e-3)
    assert one.vertices[:, 2].max() == pytest.approx(STATURES_M[age], abs=1e-3)


def test_children_have_larger_heads_than_adults_and_stout_people_larger_waists() -> None:
    def head(one: RestBody) -> float:
        return 1.0 - one.joints[BONE_INDEX["head"], 2] / one.vertices[:, 2].max()

    assert head(body("child")) > 1.2 * head(body("adult"))
    slim, stout = (
        np.mean([depth(body("adult", build=b, seed=s)) for s in range(6)]) for b in ("slim", "stout")
    )
    assert stout > 1.15 * slim


def test_the_choice_of_a_body_depends_on_chance_among_the_nearest_alone() -> None:
    chosen = {body("adult", seed=seed).vertices.tobytes() for seed in range(12)}
    assert len(chosen) == 2
    assert body("adult", seed=3).vertices.tobytes() == body("adult", seed=3).vertices.tobytes()


def test_thick_clothes_make_a_person_wider_than_thin_ones() -> None:
    def area(top: str, part: str) -> float:
        config = PersonConfig(name="ann", path=(Waypoint(at_m=(0.0, 0.0)),), clothes=Clothes(top=top))
        person = Person(config, np.random.default_rng(0), body=body("adult"))
        assert person.model.skin is not None
        own = np.unique(person.model.skin.triangles[person.model.skin.part == BODY_PARTS.index(part)])
        x, y, _ = np.ptp(person.model.skin.vertices[own], axis=0)
        return float(x * y)

    assert area("jacket", "abdomen") > 1.1 * area("t_shirt", "abdomen")


@pytest.mark.parametrize("speed", [0.6, 1.3])
@pytest.mark.parametrize("age", AGES)
def test_the_shoes_of_a_walking_skin_neither_sink_nor_hover(age: str, speed: float) -> None:
    person = settle(skinned(age, speed), 3.0)
    lowest = [vertices(person)[:, 2].min() for _ in walk(person, 1.5, 1 / 30, start=3.0)]
    assert min(lowest) > -0.012
    assert max(lowest) < 0.025


@pytest.mark.parametrize("age", AGES)
def test_a_foot_of_a_skin_on_the_floor_stands_still(age: str) -> None:
    person = settle(skinned(age), 3.0)
    names = [part.name for part in person.model.parts]
    soles, foot = person.model.frame.supports[:3], names.index("left_foot")
    track = []
    for _ in walk(person, 3.0, 1 / 120, start=3.0):
        pose = person.poses()[foot]
        track.append(pose[:3, :3] @ soles[1] + pose[:3, 3])
    ball = np.array(track)
    is_down = ball[:, 2] < 0.004
    edges = np.flatnonzero(np.diff(is_down.astype(int)))
    stays = [ball[a + 1 : b + 1] for a, b in pairwise(edges) if is_down[a + 1]]
    assert len(stays) >= 2
    for stay in stays:
        assert np.hypot(*np.ptp(stay[:, :2], axis=0)) < 0.02
