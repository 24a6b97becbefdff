"""Textures of surfaces, as grids of temperature and brightness."""

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.places.extent import Extent, shape_extents
from peopleboy.sim.places.place import Fixture
from peopleboy.sim.shapes.materials import Painting, Unrolling

Array = NDArray[np.float64]
Samples = NDArray[np.int64]

# Clouds: smooth noise with structure at all scales, like stains, drafts and moisture.

_SIDE = 512
_SLOPE = 2.0  # exponent of frequency in the amplitude: conduction smooths details; 1 is grainy
_COARSEST = 4  # blotches per side: limits their size, so that a wall has several


@dataclass(frozen=True, slots=True, eq=False)
class Clouds:
    """A square of noise with standard deviation 1 that repeats seamlessly."""

    square: Array

    def at(self, across: Array, up: Array, metres: float) -> Array:
        """Return interpolated noise (H, W) at points (1, W) and (H, 1) [m], with a blotch width [m]."""
        scale = _SIDE / (_COARSEST * metres)
        return _interpolate(self.square, *_between(up[:, 0] * scale), *_between(across[0] * scale))


@njit(cache=True, nogil=True)
def _interpolate(
    square: Array, low: Samples, high: Samples, b: Array, left: Samples, right: Samples, a: Array
) -> Array:
    """Interpolate a square: (H, W) for samples and weights of rows (H,) and columns (W,)."""
    found = np.empty((len(b), len(a)))
    for v in range(len(b)):
        below, above = square[low[v]], square[high[v]]
        row = below + b[v] * (above - below)
        for u in range(len(a)):
            before = row[left[u]]
            found[v, u] = before + a[u] * (row[right[u]] - before)
    return found


def _between(at: Array) -> tuple[Samples, Samples, Array]:
    """Return the samples (N,) before and after each position, and the interpolation weight."""
    whole = np.floor(at)
    before = whole.astype(np.int64) % _SIDE
    return before, (before + 1) % _SIDE, at - whole


def draw_clouds(rng: np.random.Generator) -> Clouds:
    """Draw noise with an amplitude that falls with frequency (spectral synthesis)."""
    frequency = np.hypot(np.fft.fftfreq(_SIDE)[:, None], np.fft.rfftfreq(_SIDE)[None, :]) * _SIDE
    amplitude = np.where(frequency >= _COARSEST, np.maximum(frequency, 1.0) ** -_SLOPE, 0.0)
    spectrum = amplitude * np.fft.rfft2(rng.standard_normal((_SIDE, _SIDE)))
    square = np.fft.irfft2(spectrum, (_SIDE, _SIDE))
    return Clouds(square / square.std())


_FINEST_M, _MOST_TEXELS = 0.025, 300_000
_FINEST_OF_THINGS_M, _TEXELS_OF_THINGS = 0.01, 20_000


@dataclass(slots=True, kw_only=True, eq=False)
class SurfaceTexture:
    """A texture under construction, with H rows upward and W columns across.

    Attributes:
        unrolling: mapping to the part.
        origin_m: [m] position of the first texel, in the part's frame.
        texel_m: [m] size of a texel.
        across: (1, W) [m] from the left edge to the right one.
        up: (H, 1) [m] from the lower edge to the upper one.
        size: (W, H) of the surface [m].
        world: (H, W, 3) [m] points in the world; for objects with several sides, those of a plane through the
            middle.
        clouds: noise samples.
        rng: random generator for everything else.
        air_k: [K] air temperature minus that of the surface.
        kelvin, light: (H, W) current values.
    """

    unrolling: Unrolling
    origin_m: tuple[float, float]
    texel_m: float
    across: Array
    up: Array
    size: tuple[float, float]
    world: Array
    clouds: Clouds
    rng: np.random.Generator
    air_k: float
    kelvin: Array
    light: Array

    def cloudy(self, metres: float, flatter: float = 1.0) -> Array:
        """Return noise (H, W) with standard deviation 1 and a width of the largest blotches [m].

        Each call uses another part of the noise. Blotches are as high as wide, or flatter by a factor.
        """
        x, y = self.rng.uniform(0.0, 100.0, 2)
        return self.clouds.at(self.across + x, flatter * self.up + y, metres)

    def strip(self, distance: Array, half_m: float | Array, soft_m: float) -> Array:
        """Return 1 where a distance [m] is below a half width, and 0 beyond, with a soft edge."""
        return np.clip((half_m + soft_m - np.abs(distance)) / (soft_m + 0.5 * self.texel_m), 0.0, 1.0)

    def lines(self, along: Array, pitch_m: float, width_m: float) -> Array:
        """Return 1 on lines that repeat with a period [m] along a coordinate, else 0."""
        off = np.abs((along + 0.5 * pitch_m) % pitch_m - 0.5 * pitch_m)
        return self.strip(off, 0.5 * width_m, 0.6 * self.texel_m)

    def cells(self, across_m: float, up_m: float) -> Array:
        """Return (H, W) one number per cell of a grid, with standard deviation 1."""
        column, row = np.floor(self.across / across_m).astype(int), np.floor(self.up / up_m).astype(int)
        drawn = self.rng.standard_normal((row.max() + 1, column.max() + 1))
        return np.asarray(drawn[row, column])

    def painting(self) -> Painting:
        """Return the finished texture."""
        kelvin, light = self.kelvin.astype(np.float32), self.light.astype(np.float32)
        return Painting(
            unrolling=self.unrolling, origin_m=self.origin_m, texel_m=self.texel_m, kelvin=kelvin, light=light
        )


def begin(
    fixture: Fixture,
    clouds: Clouds,
    rng: np.random.Generator,
    *,
    is_shell: bool,
    is_leafy: bool,
    air_k: float,
) -> SurfaceTexture:
    """Start a texture on a fixture: level for floors and ceilings, slanted for leaves, else upright."""
    extents = np.array(shape_extents(fixture))
    low, high = extents[:, 0].min(axis=0), extents[:, 1].max(axis=0)
    is_level = is_shell and high[2] - low[2] < 0.5 * min(high[0] - low[0], high[1] - low[1])
    unrolling = Unrolling.LEVEL if is_level else Unrolling.ASLANT if is_leafy else Unrolling.UPRIGHT
    start, size = _span(low, high, unrolling)
    texel = _texel(size, is_shell=is_shell)
    columns, rows = (max(int(np.ceil(side / texel)), 2) for side in size)
    across: Array = (np.arange(columns, dtype=np.float64) + 0.5) * texel
    up: Array = (np.arange(rows, dtype=np.float64) + 0.5) * texel
    return SurfaceTexture(
        unrolling=unrolling,
        origin_m=(start[0] + 0.5 * texel, start[1] + 0.5 * texel),
        texel_m=texel,
        across=across[None, :],
        up=up[:, None],
        size=size,
        world=_world(fixture, (low, high), start[0] + across, start[1] + up, is_level=is_level),
        clouds=clouds,
        rng=rng,
        air_k=air_k,
        kelvin=np.zeros((rows, columns)),
        light=np.ones((rows, columns)),
    )


def _span(low: Array, high: Array, unrolling: Unrolling) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return origin and size of the surface, across and up [m]."""
    if unrolling is Unrolling.LEVEL:
        return (low[0], low[1]), (high[0] - low[0], high[1] - low[1])
    across, up = (low[0] + low[1], high[0] + high[1]), (low[2], high[2])
    if unrolling is Unrolling.ASLANT:
        up = up[0] + 0.5 * (low[0] - high[1]), up[1] + 0.5 * (high[0] - low[1])
    return (across[0], up[0]), (across[1] - across[0], up[1] - up[0])


def _texel(size: tuple[float, float], *, is_shell: bool) -> float:
    finest, most = (_FINEST_M, _MOST_TEXELS) if is_shell else (_FINEST_OF_THINGS_M, _TEXELS_OF_THINGS)
    return max(finest, float(np.sqrt(size[0] * size[1] / most)))


def _world(
    fixture: Fixture, extent: Extent | tuple[Array, Array], u: Array, v: Array, *, is_level: bool
) -> Array:
    """Return points (H, W, 3) of the surface: a floor's top, a ceiling's underside, else the middle."""
    low, high = extent
    own = np.zeros((len(v), len(u), 3))
    if is_level:
        own[..., 0], own[..., 1] = u[None, :], v[:, None]
        own[..., 2] = high[2] if fixture.position[2] < 1.0 else low[2]
    else:
        along = 0 if high[0] - low[0] >= high[1] - low[1] else 1
        middle = 0.5 * (low + high)
        own[..., along], own[..., 1 - along] = u[None, :] - middle[1 - along], middle[1 - along]
        own[..., 2] = v[:, None]
    pose = pose_matrices(fixture.position, fixture.orientation)
    return own @ pose[:3, :3].T + pose[:3, 3]
