"""Compute statistics of thermal images: grey, gradients, noise, and the contrast of people."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.sim_to_real.clips import ClipFrame, Grey, background_corners, covered, shrunk

Floats = NDArray[np.float64]

GREY_EDGES: Final = np.arange(0.0, 257.0, 4.0)
GRADIENT_EDGES: Final = np.concatenate([[0.0], np.geomspace(1.0, 128.0, 22)])
CONTRAST_EDGES: Final = np.arange(-160.0, 250.0, 10.0)
_WINDOW: Final = 64
_WINDOWS: Final = 3
_STEADY: Final = 0.9  # share of the pixels that counts as noise; the rest may be moving objects
_LEFT: Final = 0.7895  # root mean square of that share of a standard normal distribution


@dataclass(frozen=True, slots=True, eq=False)
class ImageStatistics:
    """Statistics of some images.

    Attributes:
        grey: (64,) share of pixels by grey.
        gradient: (22,) share of pixels of the shrunken pictures by gradient magnitude [grey/px].
        spectrum: (32,) power of background by spatial frequency, up to half a cycle a pixel [grey^2].
        noise_spectrum: (32,) the same of differences between a picture and the next, halved.
        contrast: (P,) people's mean grey less that of a ring around their box [grey].
        contrast_in_ring: (P,) the same in standard deviations of the ring.
        deviation: standard deviation of the background of a picture, mean over pictures [grey].
        noise: standard deviation of noise from differences between pictures, median over pictures [grey].
        clipped: share of pixels of value 0 or 255.
    """

    grey: Floats
    gradient: Floats
    spectrum: Floats
    noise_spectrum: Floats
    contrast: Floats
    contrast_in_ring: Floats
    deviation: float
    noise: float
    clipped: float


def measure_images(moments: list[ClipFrame], rng: np.random.Generator) -> ImageStatistics:
    """Return the statistics of pictures, which have equal weight."""
    contrasts = [pair for moment in moments for pair in contrasts_of(moment)]
    table = np.array(contrasts, np.float64).reshape(-1, 2)
    steady = [moment for moment in moments if moment.later is not None]
    spectra = [_spectra(moment, rng) for moment in steady]
    return ImageStatistics(
        grey=_mean([_shares(moment.grey, GREY_EDGES) for moment in moments]),
        gradient=_mean([_shares(gradient(shrunk(moment.grey)), GRADIENT_EDGES) for moment in moments]),
        spectrum=_mean([still for still, _ in spectra]),
        noise_spectrum=_mean([change for _, change in spectra]),
        contrast=table[:, 0],
        contrast_in_ring=table[:, 1],
        deviation=float(np.mean([background_deviation(moment) for moment in moments])),
        noise=float(np.median([noise_of(moment) for moment in steady])) if steady else float("nan"),
        clipped=float(np.mean([np.isin(moment.grey, (0, 255)).mean() for moment in moments])),
    )


def gradient(grey: Grey) -> Floats:
    """Return the magnitude (H, W) of the gradient by central differences [grey/px]."""
    down, right = np.gradient(grey.astype(np.float64))
    return np.asarray(np.hypot(down, right))


def background_deviation(moment: ClipFrame) -> float:
    """Return the standard deviation of grey outside people's boxes; of the whole picture if they fill it."""
    free = ~covered(moment.grey.shape, moment.boxes)
    return float((moment.grey[free] if free.any() else moment.grey).std())


def noise_of(moment: ClipFrame) -> float:
    """Return the standard deviation of noise, from changes outside boxes, without the largest tenth.

    For normal noise, the result is its standard deviation.
    """
    assert moment.later is not None
    free = ~covered(moment.grey.shape, moment.boxes, grown=0.5)
    change = (moment.later.astype(np.float64) - moment.grey)[free]
    if not change.size:
        return float("nan")
    apart = np.sort(np.abs(change - np.median(change)))
    steady = apart[: max(round(_STEADY * len(apart)), 1)]
    return float(np.sqrt((steady**2).mean() / 2.0) / _LEFT)


def contrasts_of(moment: ClipFrame) -> list[tuple[float, float]]:
    """Return the contrast of every clear person to a ring around the box: [grey], [deviations of the ring].

    The ring extends half the box's size beyond it on every side, without other people's boxes.
    """
    taken = covered(moment.grey.shape, moment.boxes, grown=0.0)
    found = []
    for box in moment.boxes[moment.clear]:
        ring = covered(moment.grey.shape, box[None], grown=0.5) & ~taken
        left, top, width, height = box
        inner = np.array([[left + 0.25 * width, top + 0.1 * height, 0.5 * width, 0.8 * height]])
        own = covered(moment.grey.shape, inner, grown=0.0)
        if ring.any() and own.any():
            around = moment.grey[ring].astype(np.float64)
            apart = float(moment.grey[own].mean() - around.mean())
            found.append((apart, apart / max(float(around.std()), 1.0)))
    return found


def radial_power(window: Floats) -> Floats:
    """Return the power (N / 2,) of a square window (N, N) by spatial frequency, without mean, Hann-weighted.

    White noise of variance s has the power s at every frequency.
    """
    side = len(window)
    weight = np.outer(np.hanning(side), np.hanning(side))
    power = np.abs(np.fft.fft2((window - window.mean()) * weight)) ** 2 / (weight**2).sum()
    frequency = np.hypot(*np.meshgrid(np.fft.fftfreq(side), np.fft.fftfreq(side)))
    number = np.minimum((frequency * side + 0.5).astype(int), side // 2)
    total = np.bincount(number.ravel(), power.ravel(), minlength=side // 2 + 1)
    return np.asarray(total / np.bincount(number.ravel()))[1:]


def _spectra(moment: ClipFrame, rng: np.random.Generator) -> tuple[Floats, Floats]:
    assert moment.later is not None
    before, after = (shrunk(grey).astype(np.float64) for grey in (moment.grey, moment.later))
    corners = background_corners(moment, _WINDOWS, rng, _WINDOW) or [(0, 0)]
    windows = [(slice(row, row + _WINDOW), slice(column, column + _WINDOW)) for row, column in corners]
    still = np.mean([radial_power(before[at]) for at in windows], axis=0)
    change = np.mean([radial_power((after - before)[at]) / 2.0 for at in windows], axis=0)
    return still, change


def _shares(values: NDArray[np.uint8] | Floats, edges: Floats) -> Floats:
    return np.histogram(values, np.append(edges[:-1], np.inf))[0] / values.size


def _mean(rows: list[Floats]) -> Floats:
    return np.mean(rows, axis=0) if rows else np.zeros(_WINDOW // 2)
