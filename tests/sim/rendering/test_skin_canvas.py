"""Skins against rays through every triangle, and their consistency."""

import hashlib
import os
import subprocess
import sys
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from peopleboy.sim.geometry.pinhole import invert_pose
from peopleboy.sim.people.body.body_shapes import BODY_PARTS
from peopleboy.sim.rendering.edges import smooth
from peopleboy.sim.rendering.renderer import PINHOLE_RENDERER, RenderPass, Scene, look
from peopleboy.sim.shapes.skins import PosedSkins
from peopleboy.sim.world import SimulatedWorld
from peopleboy.sim.world_config import WorldConfig
from tests.helpers.worlds.small_worlds import SMALL, config, person

# Side by side, one behind the other, and cut off by three borders of the image.
PLACES = ((2.5, 0.3), (4.0, -0.3), (4.6, -0.1), (2.0, -0.9))
KINDS = (
    {"age": "child", "height_m": 1.15},
    {"age": "elder", "sex": "female", "height_m": 1.6},
    {"build": "stout"},
    {"arms": "raised", "height_m": 1.95},
)


def world_config(*places: tuple[float, float]) -> WorldConfig:
    people = [
        person(f"p{k}", place, **kind) for k, (place, kind) in enumerate(zip(places, KINDS, strict=False))
    ]
    return config(*people, bodies="skins")


def seen(*places: tuple[float, float], pose: np.ndarray | None = None) -> RenderPass:
    """The view of people alone by a small camera, on the robot 1.2 m above the floor unless given."""
    with SimulatedWorld(world_config(*places)) as world:
        world.step(0.0, 0.0)
        scene = world._scene
        if pose is None:
            pose = world.robot.world_from_robot() @ SMALL.robot_from_camera
        return look(PINHOLE_RENDERER, scene.without(scene.person_of_part < 0), SMALL, pose)


@cache
def group() -> RenderPass:
    return seen(*PLACES)


def skins_of(scene: Scene) -> PosedSkins:
    assert scene.skins is not None
    return scene.skins


def cast_rays(seen: RenderPass) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Depth, part and normal at each pixel, by the ray through its centre and every triangle's front."""
    skins = skins_of(seen.scene)
    pose, triangles = invert_pose(seen.world_from_camera), skins.table.triangles
    points = skins.vertices @ pose[:3, :3].T + pose[:3, 3]
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    volume = (normal * a).sum(axis=1)
    shape = seen.view.part.shape
    depth, part, shade = np.full(shape, np.inf), np.full(shape, -1), np.zeros((*shape, 3))
    (centre_u, centre_v), focal = SMALL.centre_px, SMALL.focal_px
    edges = np.cross(b, c), np.cross(c, a), np.cross(a, b)
    for v in range(shape[0]):
        for u in range(shape[1]):
            ray = np.array([(u - centre_u) / focal, (v - centre_v) / focal, 1.0])
            shares = np.stack([edge @ ray for edge in edges], axis=1)
            z = volume / (normal @ ray)
            hit = (volume < 0.0) & (shares <= 0.0).all(axis=1) & (z >= 0.05)
            if hit.any():
                t = int(np.where(hit, z, np.inf).argmin())
                depth[v, u], part[v, u] = z[t], skins.table.part[t]
                mixed = shares[t] / shares[t].sum() @ skins.normals[triangles[t]]
                shade[v, u] = mixed / np.linalg.norm(mixed)
    return depth, part, shade


def check_against_rays(one: RenderPass) -> None:
    depth, part, normal = cast_rays(one)
    assert np.array_equal(one.view.part, part)
    assert np.allclose(one.view.depth[part >= 0], depth[part >= 0], rtol=1e-6)
    # Normals that would face away are turned to the outline.
    cosine = (one.view.normal * normal).sum(axis=-1)[part >= 0]
    assert np.quantile(cosine, 0.1) > 0.999
    assert np.abs(np.linalg.norm(one.view.normal, axis=-1)[part >= 0] - 1.0).max() < 1e-5


def test_skins_are_drawn_where_rays_meet_their_triangles() -> None:
    check_against_rays(group())
    assert len(np.unique(group().view.part)) > 20


@pytest.mark.thorough
def test_triangles_across_the_near_plane_are_drawn_where_rays_meet_them() -> None:
    pose = np.eye(4)
    # To the left past the chest of a child that stands in front of the camera.
    pose[:3, :3] = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    pose[:3, 3] = 2.5, 0.12, 0.8
    one = seen((2.5 + 0.14, 0.3), pose=pose)
    skins, (_, part, _) = skins_of(one.scene), cast_rays(one)
    z = (skins.vertices - pose[:3, 3])[:, 1][skins.table.triangles]
    is_across = (z.min(axis=1) < 0.05) & (z.max(axis=1) > 0.05)
    assert np.count_nonzero(is_across) > 10
    assert np.isin(skins.table.part[is_across], np.unique(part)).any()
    check_against_rays(one)


def test_cover_holds_the_silhouette_that_each_person_has_alone() -> None:
    one = group()
    for k in range(len(PLACES)):
        own = one.scene.person_of_part == k
        alone = PINHOLE_RENDERER.view(one.scene.only(own), SMALL, one.world_from_camera)
        bit = (one.view.cover >> np.uint64(k)) & np.uint64(1)
        assert np.array_equal(bit == 1, alone.part >= 0)


def test_bounds_enclose_the_silhouette_within_a_pixel_and_areas_count_it() -> None:
    one = seen((6.0, 0.0))
    parts = (one.scene.person_of_part == 0)[None]
    bounds = one.bounds(parts)[0]
    v, u = np.nonzero(one.view.part >= 0)
    assert np.all(np.abs(bounds - [u.min(), v.min(), u.max(), v.max()]) <= 1.0)
    assert one.area(parts[0], bounds) == len(u)


def test_a_person_who_is_cut_off_has_a_larger_silhouette_than_the_image_shows() -> None:
    one = seen((2.3, 0.0))
    own = one.scene.person_of_part == 0
    bounds = one.bounds(own[None])[0]
    inside = np.count_nonzero(one.view.part >= 0)
    assert bounds[3] > SMALL.height
    assert one.area(own, bounds) > 1.1 * inside


def test_skins_are_closed_and_lie_within_the_persons_height() -> None:
    with SimulatedWorld(world_config(*PLACES)) as world:
        world.step(0.0, 0.0)
        skins = skins_of(world._scene)
        for k, who in enumerate(world.crowd.people):
            first, end = skins.table.first_triangle[k : k + 2]
            corners = skins.table.triangles[first:end]
            edges = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
            _, count = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
            assert np.mean(count == 2) > 0.999
            own = skins.vertices[skins.table.first_vertex[k] : skins.table.first_vertex[k + 1], 2]
            assert own.min() > -0.01
            if who.config.arms != "raised":
                assert own.max() == pytest.approx(who.config.height_m, abs=0.03)
            assert np.isin(np.unique(skins.table.part[first:end]), np.arange(1000)).sum() == len(BODY_PARTS)


def digests() -> list[str]:
    """Digests of the view of the group."""
    view = seen(*PLACES).view
    arrays = (view.part, view.depth, view.normal, view.cover)
    return [hashlib.sha256(array.tobytes()).hexdigest() for array in arrays]


def test_a_fresh_process_draws_the_same_bytes() -> None:
    here = digests()
    program = "from tests.sim.rendering.test_skin_canvas import digests; print(*digests())"
    environment = {**os.environ, "PYTHONPATH": ":".join(sys.path), "PYTHONHASHSEED": "7"}
    run = subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True
    )
    assert run.stdout.split() == here


def test_edges_of_skins_are_smoothed_towards_the_shares_of_their_parts() -> None:
    one = group()
    values = np.append(np.linspace(1.0, 4.0, one.scene.hidden.size) % 1.0 + 1.0, 0.0).astype(np.float32)
    image = values[one.view.part][..., None].copy()
    smooth(image, 1e-3, one, SMALL)
    fine = replace(SMALL, width=8 * SMALL.width, height=8 * SMALL.height)
    parts = PINHOLE_RENDERER.view(one.scene, fine, one.world_from_camera).part
    share = values[parts].reshape(SMALL.height, 8, SMALL.width, 8).mean(axis=(1, 3))
    stairs, found = values[one.view.part] - share, image[..., 0] - share
    assert np.square(found).sum() < 0.45 * np.square(stairs).sum()
    assert np.abs(found).max() <= np.abs(stairs).max()
