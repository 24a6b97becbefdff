"""The truth about many worlds at an instant, as far as no image is needed for it, as arrays."""

from __future__ import annotations

from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.geometry.planar import Planar
from peopleboy.sim.truth.image_free_truth import Bystander, ImageFreeTruth

Records = NDArray[Any]

SCENE: Final = np.dtype(
    [
        ("time_s", np.float64),
        ("robot", np.float64, 3),  # [m, m, rad]
        ("velocity", np.float64, 2),  # [m/s, rad/s]
        ("is_touching", np.bool_),
        ("first", np.int64),  # of the people who are there, in records BYSTANDER
        ("end", np.int64),
    ]
)
"""An `ImageFreeTruth`, people and names aside."""

BYSTANDER: Final = np.dtype(
    [
        ("id", np.int64),
        ("position_m", np.float64, 2),
        ("heading_rad", np.float64),
        ("velocity_m_s", np.float64, 2),
        ("height_m", np.float64),
        ("radius_m", np.float64),
        ("distance_m", np.float64),
        ("bearing_rad", np.float64),
        ("box", np.float64, 4),  # NaN for none
        ("free_ray_share", np.float64),
    ]
)
"""A `Bystander`, its name aside."""


class Scenes(NamedTuple):
    """What is true in G worlds.

    Attributes:
        worlds: (G,) records SCENE.
        people: (Q,) records BYSTANDER of all who are present, one world after the other.
        names: of everybody in each world, present or not, in the order of their numbers.
        contacts: names of what each robot touches, the floor aside.
    """

    worlds: Records
    people: Records
    names: tuple[tuple[str, ...], ...]
    contacts: tuple[tuple[str, ...], ...]

    def truths(self) -> list[ImageFreeTruth]:
        """Tell of each world."""
        worlds, people = self.worlds, self._bystanders()
        rows = zip(
            worlds["time_s"].tolist(),
            (Planar(*robot) for robot in worlds["robot"].tolist()),
            _pairs(worlds["velocity"]),
            self.contacts,
            (
                tuple(people[k:end])
                for k, end in zip(worlds["first"].tolist(), worlds["end"].tolist(), strict=True)
            ),
            strict=True,
        )
        return list(map(ImageFreeTruth._make, rows))

    def _bystanders(self) -> list[Bystander]:
        people, counts = self.people, self.worlds["end"] - self.worlds["first"]
        numbers = people["id"].tolist()
        own = (names for names, count in zip(self.names, counts.tolist(), strict=True) for _ in range(count))
        boxes, is_before = people["box"].tolist(), (~np.isnan(people["box"][:, 0])).tolist()
        rows = zip(
            numbers,
            (names[number - 1] for names, number in zip(own, numbers, strict=True)),
            _pairs(people["position_m"]),
            people["heading_rad"].tolist(),
            _pairs(people["velocity_m_s"]),
            people["height_m"].tolist(),
            people["radius_m"].tolist(),
            people["distance_m"].tolist(),
            people["bearing_rad"].tolist(),
            (tuple(box) if is_there else None for box, is_there in zip(boxes, is_before, strict=True)),
            people["free_ray_share"].tolist(),
            strict=True,
        )
        return list(map(Bystander._make, rows))


def _pairs(rows: NDArray[np.float64]) -> list[tuple[float, float]]:
    """Rows (N, 2) as pairs."""
    return list(zip(rows[:, 0].tolist(), rows[:, 1].tolist(), strict=True))
