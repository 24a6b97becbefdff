"""What is painted on a person's part before it becomes a finish."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.looks.sheets import Mesh
from peopleboy.sim.shapes.finishes import Finish
from peopleboy.sim.shapes.materials import Rgb

Grid = NDArray[np.float64]

_MOST_K = 14.0


class Paint:
    """Kelvin, light and cover of one part as they grow.

    Attributes:
        mesh: the grid.
        kelvin, light, cover: (R, C) as in `Finish`.
    """

    def __init__(self, mesh: Mesh) -> None:
        self.mesh = mesh
        self.kelvin, self.light, self.cover = mesh.zeros, mesh.zeros + 1.0, mesh.zeros

    def lay(self, share: Grid, *, kelvin: float, light: float = 1.0, cover: float = 0.0) -> None:
        """Cover a share 0..1 of each texel with something of its own: a strap, a lens, a belt."""
        for layer, value in ((self.kelvin, kelvin), (self.light, light), (self.cover, cover)):
            layer += share * (value - layer)

    def centre(self) -> None:
        """Leave the mean temperature as it is without this paint."""
        self.kelvin -= self.kelvin.mean()

    def finish(self, rgb: Rgb = (0.0, 0.0, 0.0)) -> Finish:
        """Give what has been painted."""
        return Finish(
            lowest_m=self.mesh.lowest_m,
            texel_m=self.mesh.texel_m,
            kelvin=np.clip(self.kelvin, -_MOST_K, _MOST_K),
            light=np.clip(self.light, 0.02, 1.6),
            cover=np.clip(self.cover, 0.0, 1.0),
            rgb=np.array(rgb),
        )


@dataclass(frozen=True, slots=True)
class Soft:
    """Shapes with soft edges on grids of any unit; each is (R, C), 0..1."""

    edge: float

    def within(self, value: Grid, low: float | Grid, high: float | Grid) -> Grid:
        """Where a value lies between two others."""
        return self._step(value - low) * self._step(high - value)

    def oval(self, across: Grid, up: Grid, half_across: float, half_up: float) -> Grid:
        """An ellipse round the origin."""
        away = np.hypot(across / half_across, up / half_up)
        return self._step((1.0 - away) * min(half_across, half_up))

    def _step(self, inside: Grid) -> Grid:
        return np.asarray(np.clip(0.5 + inside / self.edge, 0.0, 1.0))


def blob(across: Grid, up: Grid, sigma_across: float, sigma_up: float) -> Grid:
    """A Gaussian hill round the origin, 1 on top."""
    return np.asarray(np.exp(-0.5 * ((across / sigma_across) ** 2 + (up / sigma_up) ** 2)))
