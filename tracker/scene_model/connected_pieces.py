"""Connected components of an image, by depth and by the time of change."""

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.scene_model.scene import Labels, Metres

Bools = NDArray[np.bool_]
Pixels = NDArray[np.intp]
"""(N,) flat indices."""


@dataclass(frozen=True, slots=True, eq=False)
class PixelSpan:
    """Time of change of each pixel: (H, W) after `first_s` and before `last_s` [s].

    `seen_s` is when the present or former surface was last seen, and `slack_s` is the tolerance between the
    changes of neighbours in one component.
    """

    first_s: Metres
    last_s: Metres
    seen_s: Metres
    slack_s: float


def pieces_of(
    mask: Bools, depth_m: Metres, gap_m: float, span: PixelSpan | None = None
) -> tuple[Labels, int]:
    """Label the connected components of a mask (H, W).

    A pixel is connected with any of its eight neighbours if their depths differ by less than `gap_m`, and if
    they can have changed at the same time.

    Returns:
        (H, W) labels from 1 on, 0 outside; and the number of components.
    """
    nothing = np.zeros((1, 1), np.float32)
    first, last, slack = (
        (nothing, nothing, -1.0) if span is None else (span.first_s, span.last_s, span.slack_s)
    )
    labels, count = _label(mask, depth_m, np.float32(gap_m), first, last, np.float32(slack))
    return labels, int(count)


def pixels_by_label(labels: Labels, count: int) -> list[tuple[int, Pixels]]:
    """Return the pixels of each label from 1 on."""
    flat = labels.ravel()
    inside = np.flatnonzero(flat)
    order = inside[np.argsort(flat[inside], kind="stable")]
    ends = np.cumsum(np.bincount(flat[inside], minlength=count + 1))
    return list(enumerate(np.split(order, ends[:-1])))[1:]


@njit(cache=True, nogil=True)
def _root(parent, k):  # type: ignore[no-untyped-def]
    while parent[k] != k:
        parent[k] = parent[parent[k]]
        k = parent[k]
    return k


@njit(cache=True, nogil=True)
def _belongs(depth, gap, first, last, slack, a, b):  # type: ignore[no-untyped-def]
    """Return whether two neighbouring pixels are connected."""
    if abs(depth[a] - depth[b]) > gap * max(1.0, depth[a] / 4.0):
        return False
    return slack < 0.0 or max(first[a], first[b]) <= min(last[a], last[b]) + slack


@njit(cache=True, nogil=True)
def _label(mask, depth, gap, first, last, slack):  # type: ignore[no-untyped-def]
    height, width = mask.shape
    labels = np.zeros((height, width), np.int32)
    parent = np.zeros(height * width // 2 + 2, np.int32)
    count = 0
    for v in range(height):
        for u in range(width):
            if not mask[v, u]:
                continue
            own = 0
            for k in range(4):  # left, and the three above
                row, column = (v, u - 1) if k == 0 else (v - 1, u + k - 2)
                if row < 0 or column < 0 or column >= width or not mask[row, column]:
                    continue
                if _belongs(depth, gap, first, last, slack, (v, u), (row, column)):
                    other = _root(parent, labels[row, column])
                    own = other if own == 0 else min(own, other)
                    parent[max(own, other)] = own
                    parent[_root(parent, labels[row, column])] = own
                    if labels[v, u]:
                        parent[_root(parent, labels[v, u])] = own
                    labels[v, u] = own
            if own == 0:
                count += 1
                parent[count] = count
                labels[v, u] = count
    return _numbered(labels, parent, count)


@njit(cache=True, nogil=True)
def _numbered(labels, parent, count):  # type: ignore[no-untyped-def]
    """Number the roots from 1 on, and label every pixel with its root's number."""
    number = np.zeros(count + 1, np.int32)
    found = 0
    for k in range(1, count + 1):
        if _root(parent, k) == k:
            found += 1
            number[k] = found
    for v in range(labels.shape[0]):
        for u in range(labels.shape[1]):
            if labels[v, u]:
                labels[v, u] = number[_root(parent, labels[v, u])]
    return labels, found
