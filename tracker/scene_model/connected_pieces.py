"""Connected components of an image, by depth and by the time of change."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from peopleboy.tracker.scene_model.scene import Labels, Metres

Bools = NDArray[np.bool_]
Pixels = NDArray[np.intp]
"""(N,) flat indices."""

_ALL, _TO, _FROM = slice(None), slice(1, None), slice(None, -1)
_NEIGHBOURS: Final = (
    ((_ALL, _TO), (_ALL, _FROM)),
    ((_TO, _TO), (_FROM, _FROM)),
    ((_TO, _ALL), (_FROM, _ALL)),
    ((_TO, _FROM), (_FROM, _TO)),
)
"""Pixels, and those to the left of them, and above to the left, in the middle and to the right."""


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
    number = np.full(mask.shape, -1, np.int32)
    number[mask] = np.arange(np.count_nonzero(mask))
    pairs = []
    for here, there in _NEIGHBOURS:
        nearer = np.float64(np.float32(gap_m)) * np.maximum(depth_m[here].astype(np.float64) / 4.0, 1.0)
        is_one = mask[here] & mask[there] & (np.abs(depth_m[here] - depth_m[there]) <= nearer)
        if span is not None:
            first = np.maximum(span.first_s[here], span.first_s[there])
            last = np.minimum(span.last_s[here], span.last_s[there])
            is_one &= first <= last + np.float32(span.slack_s)
        pairs.append((number[here][is_one], number[there][is_one]))
    rows, columns = (np.concatenate(side) for side in zip(*pairs, strict=True))
    nodes = int(np.count_nonzero(mask))
    graph = coo_array((np.ones(len(rows), np.int8), (rows, columns)), shape=(nodes, nodes))
    count, component = connected_components(graph, directed=False)
    labels = np.zeros(mask.shape, np.int32)
    labels[mask] = component + 1
    return labels, int(count)


def pixels_by_label(labels: Labels, count: int) -> list[tuple[int, Pixels]]:
    """Return the pixels of each label from 1 on."""
    flat = labels.ravel()
    inside = np.flatnonzero(flat)
    order = inside[np.argsort(flat[inside], kind="stable")]
    ends = np.cumsum(np.bincount(flat[inside], minlength=count + 1))
    return list(enumerate(np.split(order, ends[:-1])))[1:]
