"""Grids wrapped round the parts of a body: crumpled cloth, and the paint of a finish."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.shapes.materials import Finish, Rgb

Grid = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """The grid of one part's finish, in the layout of `Finish`.

    Attributes:
        lowest_m: [m] z of the lowest row, the first one.
        texel_m: [m] distance between rows.
        turn: (1, C) [rad] direction from +x of each column, within -pi..pi.
        z: (R, 1) [m].
        down: (R, 1) 0 in the top row, 1 in the lowest.
    """

    lowest_m: float
    texel_m: float
    turn: Grid
    z: Grid
    down: Grid

    @property
    def zeros(self) -> Grid:
        """(R, C)."""
        return np.zeros((self.z.shape[0], self.turn.shape[1]))

    @property
    def front(self) -> Grid:
        """(1, C) 1 to the front, -1 to the back."""
        return np.cos(self.turn)

    @property
    def left(self) -> Grid:
        """(1, C) 1 to the left, -1 to the right."""
        return np.sin(self.turn)


def make_mesh(low_m: float, high_m: float, round_m: float, texel_m: float) -> Mesh:
    """Return a grid round a part, from its lowest to its highest point and of the given girth [m]."""
    rows = max(int(np.ceil((high_m - low_m) / texel_m)) + 1, 3)
    columns = max(round(round_m / texel_m), 8)
    turn = (2.0 * np.pi * np.arange(columns) / columns + np.pi) % (2.0 * np.pi) - np.pi
    z: Grid = low_m + texel_m * np.arange(rows, dtype=np.float64)
    return Mesh(low_m, texel_m, turn[None, :], z[:, None], 1.0 - np.linspace(0.0, 1.0, rows)[:, None])


@dataclass(frozen=True, slots=True, eq=False)
class FabricSheet:
    """Crumpled cloth on a grid: row 0 is the lowest, columns wrap around.

    Attributes:
        touch: (R, C) about -1..1, high where the cloth touches the skin, low where it stands off.
        crease: (R, C) 0..1, high along sharp folds.
        relief: (R, C) slope of the folds, standard deviation 1; positive faces up.
    """

    touch: Grid
    crease: Grid
    relief: Grid


def crumple(mesh: Mesh, fold_m: float, rng: np.random.Generator) -> FabricSheet:
    """Draw crumpled cloth with folds `fold_m` [m] apart that slant across the part, as on limbs."""
    shape = mesh.zeros.shape
    noise = [rng.standard_normal(shape) for _ in range(4)]
    touch = _band(noise[0], mesh.texel_m, 3.0 * fold_m, 6.0 * fold_m, 0.0)
    slanted = [_band(noise[k], mesh.texel_m, 2.4 * fold_m, fold_m, s) for k, s in ((1, 0.7), (2, -0.7))]
    folds = _unit(slanted[0] + slanted[1])
    rare = _band(noise[3], mesh.texel_m, 3.0 * fold_m, 3.0 * fold_m, 0.0)
    crease = np.exp(-((folds / 0.22) ** 2)) / (1.0 + np.exp(-4.0 * rare))
    return FabricSheet(np.tanh(1.2 * touch), crease, np.clip(_unit(np.gradient(folds, axis=0)), -2.5, 2.5))


def streaks(mesh: Mesh, across_m: float, along_m: float, rng: np.random.Generator) -> Grid:
    """Draw (R, C) streaks of standard deviation 1 along z, of the given width and length [m], for hair."""
    return _band(rng.standard_normal(mesh.zeros.shape), mesh.texel_m, across_m, along_m, 0.0)


def _band(noise: Grid, texel_m: float, across_m: float, along_m: float, slant: float) -> Grid:
    """Band-pass noise to about these wavelengths [m] round and along the part, sheared by a slant."""
    rows, columns = noise.shape
    # The transform is periodic; twice as many rows keep the top from repeating the bottom.
    padded = np.concatenate([noise, noise[::-1]], axis=0)
    along = np.fft.fftfreq(2 * rows, texel_m)[:, None]
    across = np.fft.rfftfreq(columns, texel_m)[None, :]
    frequency = np.hypot((across + slant * along * along_m / across_m) * across_m, along * along_m)
    gain = np.exp(-0.5 * (np.log(np.maximum(frequency, 1e-6)) / 0.45) ** 2)
    wave = np.fft.irfft2(np.fft.rfft2(padded) * gain, s=padded.shape)
    return _unit(wave[:rows])


def _unit(grid: Grid) -> Grid:
    centred = grid - grid.mean()
    return np.asarray(centred / max(float(centred.std()), 1e-9))


_MOST_K = 14.0


class Paint:
    """Accumulates the temperature, light and cover of one part's finish.

    Attributes:
        mesh: the grid.
        kelvin, light, cover: (R, C) as in `Finish`.
    """

    def __init__(self, mesh: Mesh) -> None:
        self.mesh = mesh
        self.kelvin, self.light, self.cover = mesh.zeros, mesh.zeros + 1.0, mesh.zeros

    def lay(self, share: Grid, *, kelvin: float, light: float = 1.0, cover: float = 0.0) -> None:
        """Cover a share 0..1 of each texel with another material: a strap, a lens, a belt."""
        for layer, value in ((self.kelvin, kelvin), (self.light, light), (self.cover, cover)):
            layer += share * (value - layer)

    def centre(self) -> None:
        """Shift the temperatures so that the paint does not change their mean."""
        self.kelvin -= self.kelvin.mean()

    def finish(self, rgb: Rgb = (0.0, 0.0, 0.0)) -> Finish:
        """Return the finish that has been painted."""
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
        """Return 1 where a value lies between two others, with soft edges."""
        return self._step(value - low) * self._step(high - value)

    def oval(self, across: Grid, up: Grid, half_across: float, half_up: float) -> Grid:
        """Return an ellipse centred at the origin."""
        away = np.hypot(across / half_across, up / half_up)
        return self._step((1.0 - away) * min(half_across, half_up))

    def _step(self, inside: Grid) -> Grid:
        return np.asarray(np.clip(0.5 + inside / self.edge, 0.0, 1.0))


def blob(across: Grid, up: Grid, sigma_across: float, sigma_up: float) -> Grid:
    """Return a Gaussian centred at the origin, 1 at its peak."""
    return np.asarray(np.exp(-0.5 * ((across / sigma_across) ** 2 + (up / sigma_up) ** 2)))
