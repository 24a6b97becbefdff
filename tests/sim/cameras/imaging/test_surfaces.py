from itertools import product

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from peopleboy.random_streams import stream
from peopleboy.sim.cameras.imaging.camera_view import make_material_table
from peopleboy.sim.cameras.imaging.surfaces import (
    PixelRun,
    finish_at,
    finish_run,
    part_from_pixel,
    pattern_value,
    smooth_variation,
    surface_point,
    turn_of,
)
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.shapes.materials import Finish, Material, PatternKind

PHASE = stream(0, "surface.variation").uniform(0.0, 1.0, (3, 3))


def pose(seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.random(rng=rng).as_matrix()
    matrix[:3, 3] = rng.normal(0.0, 3.0, 3)
    return matrix


@given(seed=st.integers(0, 999), u=st.integers(0, 319), v=st.integers(0, 239), z=st.floats(0.1, 30.0))
@settings(deadline=None, max_examples=50)
def test_a_pixel_finds_its_point_in_the_frame_of_the_part(seed: int, u: int, v: int, z: float) -> None:
    camera, world_from_camera = Pinhole(), pose(seed)
    world_from_part = np.stack([pose(seed + 1000), pose(seed + 2000)])
    matrices = part_from_pixel(camera, world_from_camera, world_from_part)
    in_camera = np.append(z * np.linalg.inv(camera.intrinsics) @ [u, v, 1.0], 1.0)
    expected = np.linalg.inv(world_from_part[1]) @ world_from_camera @ in_camera
    assert surface_point(matrices, 1, u, v, z) == pytest.approx(expected[:3], abs=1e-9)


def test_variation_is_smooth_and_fills_its_range() -> None:
    line = np.linspace(0.0, 20.0, 20001)
    values = np.array([smooth_variation(x, 0.3 * x, -0.2 * x, 2.0, PHASE, 1) for x in line])
    assert -1.0 <= values.min() < -0.8
    assert 0.8 < values.max() <= 1.0
    slope = np.diff(values) / np.diff(line)
    # Waves of parabolas: at most 8 a wave, of 2 waves a metre along oblique axes; and no kinks.
    assert np.abs(slope).max() < 8.0 * 2.0
    assert np.abs(np.diff(slope)).max() < 0.3


def test_stripes_are_level_and_repeat_with_their_period() -> None:
    def at(x: float, z: float) -> int:
        return pattern_value(PatternKind.STRIPES, 0.2, x, 0.0, z, PHASE, 0)

    heights = np.arange(0.0, 2.0, 0.001)
    values = np.array([at(0.0, z) for z in heights])
    assert values.mean() == pytest.approx(0.5, abs=0.01)
    assert np.count_nonzero(np.diff(values)) == pytest.approx(20, abs=1)
    assert all(at(x, 0.03) == at(0.0, 0.03) for x in np.linspace(-3.0, 3.0, 50))


def test_checks_alternate_along_every_axis() -> None:
    rng = np.random.default_rng(0)
    for point in rng.uniform(-2.0, 2.0, (200, 3)):
        here = pattern_value(PatternKind.CHECKS, 0.4, *point, PHASE, 0)
        for axis in range(3):
            beside = point.copy()
            beside[axis] += 0.2
            assert pattern_value(PatternKind.CHECKS, 0.4, *beside, PHASE, 0) == 1 - here


def test_a_patch_lies_on_the_front_only() -> None:
    assert pattern_value(PatternKind.PATCH, 0.3, 0.1, 0.0, 0.0, PHASE, 0) == 1
    assert pattern_value(PatternKind.PATCH, 0.3, -0.1, 0.0, 0.0, PHASE, 0) == 0
    assert pattern_value(PatternKind.PATCH, 0.3, 0.1, 0.0, 0.16, PHASE, 0) == 0
    assert pattern_value(PatternKind.PATCH, 0.3, 0.1, 0.11, 0.0, PHASE, 0) == 0


def test_speckle_is_a_blotchy_minority() -> None:
    rng = np.random.default_rng(0)
    values = [
        pattern_value(PatternKind.SPECKLE, 0.1, *point, PHASE, 0) for point in rng.uniform(-1, 1, (4000, 3))
    ]
    assert 0.2 < np.mean(values) < 0.5


def test_plain_surfaces_have_no_second_value() -> None:
    assert pattern_value(PatternKind.PLAIN, 0.1, 0.3, 0.2, 0.1, PHASE, 0) == 0


def test_no_two_parts_vary_alike_and_the_seed_repeats_them() -> None:
    materials = [Material(temperature_c=20.0)] * 3
    table = make_material_table(materials, stream(4, "surface.variation"))
    again = make_material_table(materials, stream(4, "surface.variation"))
    assert np.array_equal(table.phase, again.phase)
    assert len({tuple(row) for row in table.phase}) == 3


@given(x=st.floats(-2.0, 2.0), y=st.floats(-2.0, 2.0))
@settings(deadline=None)
def test_a_turn_is_that_of_the_arc_tangent(x: float, y: float) -> None:
    if np.hypot(x, y) > 1e-3:
        gap = turn_of(x, y) - np.arctan2(y, x) / (2.0 * np.pi)
        assert abs(gap - round(gap)) < 2e-5


def random_finish(rows: int, columns: int) -> Finish:
    rng = np.random.default_rng(rows)
    layers = {name: rng.uniform(0.0, 1.0, (rows, columns)) for name in ("kelvin", "light", "cover")}
    return Finish(lowest_m=-0.2, texel_m=0.01, rgb=np.array([0.1, 0.2, 0.3]), **layers)


@given(x=st.floats(-1.0, 1.0), y=st.floats(-1.0, 1.0), z=st.floats(-0.3, 0.4), part=st.sampled_from([0, 2]))
@settings(deadline=None)
def test_a_finish_is_that_of_the_nearest_texel_and_closes_round_the_part(
    x: float, y: float, z: float, part: int
) -> None:
    finishes = {0: random_finish(41, 24), 2: random_finish(31, 50)}
    materials = [Material(temperature_c=20.0, finish=finishes.get(k)) for k in range(3)]
    table = make_material_table(materials, stream(0, "surface.variation"))
    assert table.finish[1, 0] < 0.0
    finish = finishes[part]
    rows, columns = finish.kelvin.shape
    across, up = turn_of(x, y) * columns, np.clip((z + 0.2) / 0.01, 0.0, rows - 1.0)
    assume(min(abs(across % 1.0 - 0.5), abs(up % 1.0 - 0.5)) > 1e-3)
    found = finish_at(table.finish, table.texels, part, x, y, z)
    for value, layer in zip(found, (finish.kelvin, finish.light, finish.cover), strict=True):
        assert value == pytest.approx(layer[int(up + 0.5), int(across + 0.5) % columns], abs=0.002)


def test_a_run_of_pixels_falls_on_the_texels_that_finishes_have_at_their_points() -> None:
    rng, finishes = np.random.default_rng(4), {0: random_finish(41, 24), 2: random_finish(31, 50)}
    materials = [Material(temperature_c=20.0, finish=finishes.get(k)) for k in range(3)]
    table = make_material_table(materials, stream(0, "surface.variation"))
    matrices = rng.uniform(-0.02, 0.02, (3, 3, 4))
    agree = []
    for v, part in product(range(15), finishes):
        places = np.full(60, 10**6, np.uint32)
        depths = rng.uniform(0.2, 1.0, 60).astype(np.float32)
        finish_run(places, PixelRun(10, 50, part, v, depths, matrices), table.finish)
        assert np.all(places[:10] == 10**6)
        assert np.all(places[50:] == 10**6)
        for u in range(10, 50):
            point = matrices[part] @ (u * depths[u], v * depths[u], depths[u], 1.0)
            expected = finish_at(table.finish, table.texels, part, *point)
            agree.append(np.allclose(table.texels[places[u]] / 256.0, expected, atol=1e-9))
    # Between two texels, rounding may choose the other.
    assert len(agree) > 500
    assert np.mean(agree) > 0.995


def test_without_finishes_the_table_has_none() -> None:
    table = make_material_table([Material(temperature_c=20.0)] * 2, stream(0, "surface.variation"))
    assert table.finish.shape == (0, 8)
    assert table.texels.shape == (0, 3)
