from functools import cache

import numpy as np
import pytest

from peopleboy.random_streams import stream
from peopleboy.sim.people.appearance.finisher import Finisher
from peopleboy.sim.people.body.clothes import Clothes
from peopleboy.sim.people.person import Person
from peopleboy.sim.people.person_config import PersonConfig, Waypoint
from peopleboy.sim.shapes.materials import Finish, Material

STANDING = (Waypoint(at_m=(0.0, 0.0)),)
PLAIN = Clothes(top="t_shirt", bottom="jeans")


def looks(seed: int, air_c: float | None = 21.0, **settings: object) -> dict[str, Material]:
    config = PersonConfig(**({"name": "ann", "path": STANDING, "clothes": PLAIN} | settings))
    finisher = None if air_c is None else Finisher(config, air_c, stream(seed, "looks"))
    person = Person(config, stream(seed, "person"), finisher)
    return {part.name: part.material for part in person.model.parts}


@cache
def crowd(air_c: float | None) -> tuple[dict[str, Material], ...]:
    return tuple(looks(seed, air_c) for seed in range(60))


def finish_of(material: Material) -> Finish:
    assert material.finish is not None
    return material.finish


@pytest.mark.thorough
def test_in_a_room_people_are_on_average_as_warm_as_without() -> None:
    plain, fine = crowd(None), crowd(21.0)
    for part in plain[0].keys() - {"pelvis"}:  # over which shirts hang, some of them
        before, after = (np.mean([each[part].temperature_c for each in many]) for many in (plain, fine))
        assert after == pytest.approx(before, abs=0.5), part
        painted = (
            np.mean([finish_of(each[part]).kelvin.mean() for each in fine[:30]]) if part != "bag" else 0.0
        )
        assert abs(painted) < 0.5, part


@pytest.mark.thorough
def test_people_differ_more_than_without_and_one_s_parts_go_together() -> None:
    plain, fine = crowd(None), crowd(21.0)

    def column(people: tuple[dict[str, Material], ...], part: str) -> np.ndarray:
        return np.array([each[part].temperature_c for each in people])

    for part in ("head", "chest", "left_hand"):
        assert column(fine, part).std() > 1.5 * column(plain, part).std()
    assert np.corrcoef(column(fine, "head"), column(fine, "left_forearm"))[0, 1] > 0.6
    assert np.corrcoef(column(fine, "head"), column(fine, "left_thigh"))[0, 1] > 0.1


def test_the_cold_cools_hands_and_clothes() -> None:
    warm, cold = looks(3, 24.0), looks(3, 2.0)
    assert cold["left_hand"].temperature_c < warm["left_hand"].temperature_c - 6.0
    assert cold["chest"].temperature_c < warm["chest"].temperature_c - 4.0
    assert cold["head"].temperature_c > cold["chest"].temperature_c + 3.0


def at(finish: Finish, y: float, z: float, depth: float, layer: str = "kelvin") -> float:
    """The nearest texel to a point of the front."""
    turn = np.arctan2(y, depth) / (2.0 * np.pi) % 1.0
    columns = finish.kelvin.shape[1]
    row = round((z - finish.lowest_m) / finish.texel_m)
    return float(getattr(finish, layer)[row, round(turn * columns) % columns])


@pytest.mark.parametrize("seed", range(12))
def test_a_face_has_warm_corners_of_the_eyes_a_cool_nose_and_dark_brows(seed: int) -> None:
    h, bare = 1.7, looks(seed, height_m=1.7, sex="female")["head"]
    face = finish_of(bare)
    eye, depth = 0.041 * h, 0.055 * h
    forehead, nose = at(face, 0.0, 0.062 * h, depth), at(face, 0.0, 0.021 * h, depth)
    assert nose < forehead
    assert at(face, 0.018 * h, eye + 0.011 * h, depth, "cover") > 0.5
    lens = at(face, 0.018 * h, eye, depth)
    if lens < forehead - 3.0:
        # Glass hides the eye, and is nearer to the air's temperature.
        assert bare.temperature_c + lens == pytest.approx(21.0 + 0.4 * (bare.temperature_c - 21.0), abs=0.6)
    else:
        assert at(face, 0.0085 * h, eye, depth) > forehead + 0.4
    assert at(face, 0.0, eye, -depth) == pytest.approx(
        face.kelvin[:, face.kelvin.shape[1] // 2].max(), abs=1.5
    )


@pytest.mark.slow
def test_trousers_are_creased_most_at_the_knee() -> None:
    rows = np.mean([finish_of(looks(seed)["left_thigh"]).light.std(axis=1) for seed in range(20)], axis=0)
    fifth = len(rows) // 5
    assert rows[:fifth].mean() > 1.5 * rows[2 * fifth : 3 * fifth].mean()  # row 0 is at the knee


@pytest.mark.slow
def test_an_open_jacket_shows_a_warmer_strip_of_shirt() -> None:
    jacket = Clothes(top="jacket", top_colour="black")
    chests = [finish_of(looks(seed, clothes=jacket)["chest"]) for seed in range(24)]
    opened = [chest for chest in chests if chest.cover[:, 0].mean() > 0.5]
    assert 0.3 < len(opened) / len(chests) < 0.8
    for chest in opened:
        row = chest.kelvin[chest.kelvin.shape[0] // 3]
        assert row[0] > np.median(row) + 1.0
        assert chest.rgb.min() > 0.5


def test_the_same_stream_gives_the_same_looks_and_another_does_not() -> None:
    one, again, other = (finish_of(looks(seed)["chest"]).texels() for seed in (4, 4, 5))
    assert np.array_equal(one, again)
    assert not np.array_equal(one, other)


def test_without_a_finisher_nobody_has_a_finish() -> None:
    assert all(material.finish is None for material in looks(0, None).values())


@pytest.mark.parametrize("air_c", [-20.0, 21.0, 50.0])
def test_finishes_stay_within_what_clothes_and_skin_can_be(air_c: float) -> None:
    coat, cap = (
        Clothes(top="lab_coat", bottom="skirt", hair="long"),
        Clothes(top="jacket", hair="cap", shoes="boots"),
    )
    for seed, clothes in enumerate((PLAIN, coat, cap)):
        for part, material in looks(seed, air_c, clothes=clothes).items():
            if material.finish is None:
                continue
            surface = material.temperature_c + material.finish.kelvin
            assert min(air_c, 34.0) - 6.0 < surface.min(), part
            assert surface.max() < max(40.0, air_c + 6.0), part
            assert material.finish.light.min() >= 0.0
            assert 0.0 <= material.finish.cover.min() <= material.finish.cover.max() <= 1.0
