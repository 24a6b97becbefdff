"""A coarse mesh on a fine one: reduction, projection, and cuts along the borders of parts."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]

_NEAREST = 24  # triangles of the fine mesh that are tried for each vertex, by distance of their middles
_LEAST_CUT = 0.12  # share of an edge next to its ends where it is not cut, so that triangles keep a width


@dataclass(frozen=True, slots=True, eq=False)
class Mixture:
    """Points as weighted means of K points of another mesh each.

    Attributes:
        rows: (V, K) numbers of those points.
        shares: (V, K) weights, which sum to 1.
    """

    rows: Numbers
    shares: Array

    def of(self, values: Array) -> Array:
        """Return the means (V, ...) of values (N, ...)."""
        mixed: Array = np.einsum("vk,vk...->v...", self.shares, values[self.rows])
        return mixed


def reduce(vertices: Array, triangles: Numbers, count: int) -> tuple[Array, Numbers]:
    """Return a mesh of about `count` triangles, by collapsing the edges that change the surface least.

    Source: Garland and Heckbert (1997), Surface simplification using quadric error metrics.
    """
    import fast_simplification  # imported late, as only baking needs it

    points, corners = fast_simplification.simplify(vertices, triangles, target_count=count, agg=3)
    used, corners = np.unique(corners, return_inverse=True)
    return np.asarray(points, np.float64)[used], corners.reshape(-1, 3).astype(np.int64)


def project(points: Array, vertices: Array, triangles: Numbers) -> Mixture:
    """Return the nearest points on a mesh to points (V, 3)."""
    corners = vertices[triangles]
    _, near = cKDTree(corners.mean(axis=1)).query(points, k=_NEAREST)
    shares, away = _nearest(points[:, None], corners[near])
    best = away.argmin(axis=1)
    row = np.arange(len(points))
    return Mixture(triangles[near[row, best]], shares[row, best])


def _nearest(points: Array, corners: Array) -> tuple[Array, Array]:
    """Return barycentric weights (..., 3) of the nearest points on triangles (..., 3, 3), and distances."""
    a, b, c = corners[..., 0, :], corners[..., 1, :], corners[..., 2, :]
    ab, ac, ap = b - a, c - a, points - a
    d00, d01, d11 = (ab * ab).sum(-1), (ab * ac).sum(-1), (ac * ac).sum(-1)
    d20, d21 = (ap * ab).sum(-1), (ap * ac).sum(-1)
    scale = np.maximum(d00 * d11 - d01 * d01, 1e-18)
    v, w = (d11 * d20 - d01 * d21) / scale, (d00 * d21 - d01 * d20) / scale
    inside = np.stack([1.0 - v - w, v, w], axis=-1)
    is_inside: NDArray[np.bool_] = np.min(inside, axis=-1, keepdims=True) >= 0.0
    candidates = [np.where(is_inside, inside, np.eye(3)[0])]
    for i, j in ((0, 1), (1, 2), (2, 0)):
        p, q = corners[..., i, :], corners[..., j, :]
        edge = q - p
        t = ((points - p) * edge).sum(-1) / np.maximum((edge * edge).sum(-1), 1e-18)
        t = np.clip(t, 0.0, 1.0)[..., None]
        candidates.append((1.0 - t) * np.eye(3)[i] + t * np.eye(3)[j])
    shares = np.stack(candidates)
    away = np.linalg.norm(np.einsum("n...k,...kd->n...d", shares, corners) - points, axis=-1)
    best = away.argmin(axis=0)[None]
    found: Array = np.take_along_axis(shares, best[..., None], axis=0)[0]
    return found, np.take_along_axis(away, best, axis=0)[0]


def cut(triangles: Numbers, scores: Array) -> tuple[Mixture, Numbers, Numbers]:
    """Cut triangles where the largest of several scores (V, L) changes, so that each has one label.

    Along an edge scores are linear; the cut is where those of its two ends are equal.

    Returns:
        the vertices, the first V of which are the old ones; triangles (T, 3); and their labels (T,).
    """
    label = scores.argmax(axis=1)
    rows = [(i, i, i) for i in range(len(scores))]
    shares = [(1.0, 0.0, 0.0) for _ in rows]
    known: dict[tuple[int, int], int] = {}
    corners: list[tuple[int, int, int]] = []
    labels: list[int] = []

    def between(i: int, j: int) -> int:
        i, j = min(i, j), max(i, j)
        if (i, j) not in known:
            own, other = label[i], label[j]
            before, after = scores[i, own] - scores[i, other], scores[j, own] - scores[j, other]
            t = before / (before - after) if before > after else 0.5
            t = min(max(t, _LEAST_CUT), 1.0 - _LEAST_CUT)
            known[i, j] = len(rows)
            rows.append((i, j, i))
            shares.append((1.0 - t, t, 0.0))
        return known[i, j]

    def add(kind: int, *polygon: int) -> None:
        for k in range(1, len(polygon) - 1):
            corners.append((polygon[0], polygon[k], polygon[k + 1]))
            labels.append(kind)

    for a, b, c in triangles.tolist():
        kinds = {label[a], label[b], label[c]}
        if len(kinds) == 1:
            add(label[a], a, b, c)
        elif len(kinds) == 2:
            while label[b] != label[c]:
                a, b, c = b, c, a
            p, q = between(a, b), between(a, c)
            add(label[a], a, p, q)
            add(label[b], p, b, c, q)
        else:
            middle = len(rows)
            rows.append((a, b, c))
            shares.append((1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0))
            p, q, r = between(a, b), between(b, c), between(c, a)
            add(label[a], middle, r, a, p)
            add(label[b], middle, p, b, q)
            add(label[c], middle, q, c, r)
    return Mixture(np.array(rows), np.array(shares)), np.array(corners), np.array(labels)
