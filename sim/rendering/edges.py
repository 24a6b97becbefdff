"""Anti-aliasing of edges: surfaces that meet within a pixel are mixed by their shares of its area.

A pixel has four rays, in different rows and columns. Next to a pixel that shows another surface, the nearest
ray is tested against both surfaces. If it hits the other one, the next nearest ray is tested, too; if not,
those of the other pixel are. Each ray gets the value of one of the two pixels. No surface is shaded twice,
and the method works for any image of the view. Pixels without contrast are skipped.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.geometry.vectors import compose
from peopleboy.sim.rendering.render_canvas import Lens
from peopleboy.sim.rendering.renderer import RenderPass
from peopleboy.sim.rendering.skin_rays import (
    NO_HITS,
    RAYS,
    SkinHits,
    differ,
    edges_of_skins,
    hit_skins,
)
from peopleboy.sim.shapes.rays import hit_shape
from peopleboy.sim.shapes.shape_table import ShapeTable
from peopleboy.sim.shapes.shapes import ShapeKind

Array = NDArray[np.float64]
Pixels = NDArray[np.int32]

_NEXT = (1, 3, 0, 2)
"""Of the rays, the next nearest to the pixel to which each is nearest."""
_BESIDE = np.array([(-1, 0), (0, 1), (0, -1), (1, 0)])  # the nearest pixels, in row and column

_BOX = int(ShapeKind.BOX)
_CAPSULE = int(ShapeKind.CAPSULE)
_MESH = int(ShapeKind.MESH)
_SKIN = int(ShapeKind.SKIN)
_NONE = -1

_BEHIND = 1.03  # beyond this ratio of depths, a surface is behind another over the whole pixel


def smooth(image: NDArray[np.float32], contrast: float, seen: RenderPass, camera: Pinhole) -> None:
    """Anti-alias the edges of an image in place; a view without surfaces is unchanged.

    Args:
        image: (H, W, C) linear in light or radiance, C-contiguous.
        contrast: least difference in any channel between two pixels of an edge.
        seen: view of a pinhole camera.
        camera: that camera.
    """
    view, scene = seen.view, seen.scene
    if view.surface is None:
        return
    lens = Lens(camera.focal_px, *camera.centre_px, camera.width, camera.height)
    poses, skins = scene.seen_from(seen.world_from_camera)
    hits = NO_HITS
    if skins is not None:
        first = skins.posed.table.first_surface
        edges, count = edges_of_skins(image, np.float32(contrast), view.part, view.surface, first)
        hits = hit_skins(skins, lens, edges, count)
    _smooth(
        image, np.float32(contrast), view.part, view.surface, view.depth, scene.table, poses, lens, hits
    )  # fmt: skip


@njit(cache=True)
def _shapes_from_camera(table: ShapeTable, camera_from_part: Array) -> Array:
    """Return (S, 3, 4) shape from camera, for each shape."""
    poses, pose = np.empty((len(table.part), 3, 4)), np.empty((3, 4))
    for shape in range(len(table.part)):
        compose(camera_from_part[table.part[shape]], table.part_from_shape[shape], pose)
        for i in range(3):
            for j in range(3):
                poses[shape, i, j] = pose[j, i]
            poses[shape, i, 3] = -(
                pose[0, i] * pose[0, 3] + pose[1, i] * pose[1, 3] + pose[2, i] * pose[2, 3]
            )
    return poses


@njit(cache=True)
def _pieces_of(table: ShapeTable) -> Pixels:
    """Return the piece (M,) of each surface.

    It is the surface itself, but for a capsule or mesh its first surface, and for a skin the first of its
    part.
    """
    pieces = np.empty(len(table.surface_shape), np.int32)
    of_part = np.full(table.surface_part.max() + 1 if len(pieces) else 0, np.int32(-1))
    for surface in range(len(pieces)):
        shape = table.surface_shape[surface]
        if table.kind[shape] == _SKIN:
            part = table.surface_part[surface]
            if of_part[part] < 0:
                of_part[part] = surface
            pieces[surface] = of_part[part]
            continue
        is_one = table.kind[shape] in (_CAPSULE, _MESH)
        pieces[surface] = table.first_surface[shape] if is_one else surface
    return pieces


@njit(cache=True)
def _mark(changes: NDArray[np.uint8], v: int, part: Pixels, surface: Pixels) -> None:
    """Mark the pixels of a row (W,) next to another surface: 1 on the right, 2 below."""
    height, width = part.shape
    for u in range(width - 1):
        changes[u] = (part[v, u] != part[v, u + 1]) | (surface[v, u] != surface[v, u + 1])
    changes[width - 1] = False
    if v + 1 < height:
        for u in range(width):
            is_other = (part[v, u] != part[v + 1, u]) | (surface[v, u] != surface[v + 1, u])
            changes[u] |= np.uint8(2) * np.uint8(is_other)


@njit(cache=True, error_model="numpy")
def _smooth(  # noqa: C901 (in one function)
    image: NDArray[np.float32],
    contrast: np.float32,
    part: Pixels,
    surface: Pixels,
    depth: NDArray[np.float32],
    table: ShapeTable,
    camera_from_part: Array,
    lens: Lens,
    hits: SkinHits,
) -> None:
    """Cast rays on both sides of each edge, and mix the surfaces that they hit.

    Rays are cast only where the values differ.

    This is a single function because passing arrays to a kernel costs as much as casting a ray.
    """
    kind, size, first_surface, shape_of = table.kind, table.size, table.first_surface, table.surface_shape
    pose, piece_of = _shapes_from_camera(table, camera_from_part), _pieces_of(table)
    faces, is_known = np.empty((len(shape_of), 15)), np.zeros(len(shape_of), np.bool_)
    height, width, channels = image.shape
    # Pixels that are mixed with others, four times the change of their value, and their positions in these
    # lists: for this row and the next.
    pixel, more = np.empty((height * width, 2), np.int32), np.empty((height * width, channels), np.float32)
    places, found = np.full((2, width), -1, np.int32), 0
    # Eight at a time, since nearly all pixels are next to others of the same surface.
    changes, scale = np.zeros(-(-width // 8) * 8, np.uint8), 1.0 / lens.focal
    eight = changes.view(np.uint64)
    for v in range(height):
        place, place_below = places[v & 1], places[1 - (v & 1)]
        place_below[:] = -1
        _mark(changes, v, part, surface)
        u = -1
        while u + 1 < width:
            u += 1
            if u % 8 == 0 and eight[u >> 3] == 0:
                u += 7
                continue
            for way in range(2):
                # Right, then below.
                if changes[u] & (1 << way) == 0:
                    continue
                far_v, far_u = (v, u + 1) if way == 0 else (v + 1, u)
                piece = _NONE if part[v, u] < 0 else piece_of[surface[v, u]]
                far_piece = _NONE if part[far_v, far_u] < 0 else piece_of[surface[far_v, far_u]]
                if piece == far_piece or not differ(image[v, u], image[far_v, far_u], contrast):
                    continue
                is_met = False
                for end in range(2):
                    # If the ray on one side hits the other surface, that on the other side is skipped.
                    if is_met:
                        break
                    if end == 0:
                        y0, x0, y1, x1, one, other = v, u, far_v, far_u, piece, far_piece
                        side = 1 if way == 0 else 3
                    else:
                        y0, x0, y1, x1, one, other = far_v, far_u, v, u, far_piece, piece
                        side = 2 if way == 0 else 0
                    first, last, count = _in_order(
                        one, other, shape_of[one] == shape_of[other], depth[y0, x0], depth[y1, x1]
                    )
                    for turn in range(2):
                        # If the ray nearest to the neighbour hits its surface, the next nearest may hit it,
                        # too, unless it is nearer to another such neighbour.
                        k = side
                        if turn == 1:
                            k = _NEXT[side]
                            y, x = y0 + _BESIDE[k, 0], x0 + _BESIDE[k, 1]
                            if 0 <= y < height and 0 <= x < width:
                                beside = _NONE if part[y, x] < 0 else piece_of[surface[y, x]]
                                if beside != one:
                                    break
                        across = (x0 + RAYS[k, 0] - lens.centre_u) * scale
                        down = (y0 + RAYS[k, 1] - lens.centre_v) * scale
                        nearest, seen = 0.0, last if count == 1 else one
                        for j in range(count):
                            p = first if j == 0 else last
                            s = shape_of[p]
                            if kind[s] == _MESH:
                                seen = one
                                break
                            if kind[s] == _SKIN:
                                number, met = hits.number[y0, x0], p
                                is_hit = hits.part[number, k] == table.surface_part[p]
                                here = hits.nearness[number, k] if is_hit else 0.0
                            elif kind[s] == _BOX:
                                if not is_known[p]:
                                    _set_face(faces[p], p - first_surface[s], size[s], pose[s])
                                    is_known[p] = True
                                here, met = _hit_face(faces[p], across, down), p
                            else:
                                o = (pose[s, 0, 3], pose[s, 1, 3], pose[s, 2, 3])
                                d = (
                                    pose[s, 0, 0] * across + pose[s, 0, 1] * down + pose[s, 0, 2],
                                    pose[s, 1, 0] * across + pose[s, 1, 1] * down + pose[s, 1, 2],
                                    pose[s, 2, 0] * across + pose[s, 2, 1] * down + pose[s, 2, 2],
                                )
                                t, local = hit_shape(kind[s], (size[s, 0], size[s, 1], size[s, 2]), o, d)
                                here, met = 1.0 / t, piece_of[first_surface[s] + local]
                            if here > nearest:
                                nearest, seen = here, met
                        if seen == one or (seen != other and shape_of[seen] == shape_of[one]):
                            break
                        is_met = True
                        row = place if y0 == v else place_below
                        i = row[x0]
                        if i < 0:
                            i = row[x0] = found
                            pixel[i, 0], pixel[i, 1] = y0, x0
                            more[i] = np.float32(0.0)
                            found += 1
                        for c in range(channels):
                            more[i, c] += image[y1, x1, c] - image[y0, x0, c]
    for i in range(found):
        for c in range(channels):
            image[pixel[i, 0], pixel[i, 1], c] += np.float32(0.25) * more[i, c]


@njit(cache=True, error_model="numpy")
def _set_face(form: Array, face: int, size: Array, pose: Array) -> None:
    """Set the coefficients for intersecting rays (x, y, 1) with a face of a box without a division.

    Args:
        form: (15,) output, five triples whose dot products with the ray are positive on the inner side of
            each of the four edges, and the nearness of the face's plane.
        face: number of the face, 0..5.
        size: (3,) size of the box.
        pose: (3, 4) box from camera.
    """
    i = face % 3
    away = (0.5 * size[i] if face < 3 else -0.5 * size[i]) - pose[i, 3]
    for c in range(3):
        plane = pose[i, c] / away
        form[12 + c] = plane
        for k in range(2):
            # The ray hits the plane at distance 1 / plane; inside the face within half the size.
            j = (face + 1 + k) % 3
            slope = pose[j, c] + pose[j, 3] * plane
            form[6 * k + c] = 0.5 * size[j] * plane - slope
            form[6 * k + 3 + c] = 0.5 * size[j] * plane + slope


@njit(cache=True, error_model="numpy")
def _hit_face(form: Array, x: float, y: float) -> float:
    """Return the nearness [1/m] at which the ray (x, y, 1) hits a face of a box, 0 for a miss."""
    a = form[0] * x + form[1] * y + form[2]
    b = form[3] * x + form[4] * y + form[5]
    c = form[6] * x + form[7] * y + form[8]
    d = form[9] * x + form[10] * y + form[11]
    near: float = form[12] * x + form[13] * y + form[14]
    return near if min(min(a, b), min(c, d)) >= 0.0 else 0.0


@njit(cache=True)
def _in_order(one: int, other: int, is_same: bool, z: float, other_z: float) -> tuple[int, int, int]:
    """Return two pieces by depth, the nearer first, and the number of shapes to test.

    Only the nearer is tested if the other is far behind, and only the second of two pieces of one shape, for
    which a miss is unknown.
    """
    if is_same and one != _NONE and other != _NONE:
        return other, one, 1
    if other_z < z:
        one, other, z, other_z = other, one, other_z, z
    return one, other, 1 if other == _NONE or other_z > _BEHIND * z else 2
