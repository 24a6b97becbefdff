"""The view of one camera at an instant, with all materials as arrays for kernels."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import CameraGeometry, Matrix
from peopleboy.sim.rendering.full_detail import FullDetail
from peopleboy.sim.rendering.view import View
from peopleboy.sim.shapes.materials import Finish, Material, Painting

_STEPS = np.array([256.0, 4096.0])  # to a kelvin, and to a factor of 1 on light
KELVIN_STEP, LIGHT_STEP = 1.0 / _STEPS


class MaterialTable(NamedTuple):
    """Materials of all P parts as arrays, for kernels; row i belongs to part i.

    Attributes:
        thermal: (P, 5) temperature [degC], emissivity, variation [K], waves per metre [1/m], contrast [K].
        colour: (P, 7) first and second reflectance, glow.
        kind: (P, 2) PatternKind of the thermal and of the colour pattern.
        period: (P, 2) [m] of the same.
        phase: (P, 3) [waves] offsets of the smooth variation.
        finish: (P, 8) first texel of each part's finish (-1 for none), columns, rows, lowest z [m], rows per
            metre, and colour; (0, 8) if no part has one.
        texels: (N, 3) kelvin, light and cover of all finishes, as in `Finish.texels`.
        shine: (P,) specular share of the reflection, 0..1.
        paint, paint_texels: textures, as returned by `make_paint_table`.
    """

    thermal: NDArray[np.float64]
    colour: NDArray[np.float64]
    kind: NDArray[np.int64]
    period: NDArray[np.float64]
    phase: NDArray[np.float64]
    finish: NDArray[np.float64]
    texels: NDArray[np.int16]
    shine: NDArray[np.float64]
    paint: NDArray[np.float64]
    paint_texels: NDArray[np.int16]


def make_material_table(
    materials: Sequence[Material],
    rng: np.random.Generator,
    paintings: Sequence[Painting | None] | None = None,
) -> MaterialTable:
    """Convert the appearance of all parts to arrays; the generator draws each part's phase of variation.

    A texture already includes the variation of its part.
    """
    finish, texels = _lay_out([material.finish for material in materials])
    paint, paint_texels = make_paint_table([None] * len(materials) if paintings is None else paintings)
    varies = paint[:, 0] < 0.0
    return MaterialTable(
        thermal=np.array(
            [
                (k.temperature_c, k.emissivity, varies[i] * k.variation_k, 1.0 / k.variation_m, k.contrast_k)
                for i, k in enumerate(materials)
            ]
        ).reshape(-1, 5),
        colour=np.array([(*k.rgb, *k.second_rgb, k.glow) for k in materials]).reshape(-1, 7),
        kind=np.array([(k.thermal_pattern.kind, k.colour_pattern.kind) for k in materials], np.int64).reshape(
            -1, 2
        ),
        period=np.array([(k.thermal_pattern.period_m, k.colour_pattern.period_m) for k in materials]).reshape(
            -1, 2
        ),
        phase=rng.uniform(0.0, 1.0, (len(materials), 3)),
        finish=finish,
        texels=texels,
        shine=np.array([k.shine for k in materials], np.float64),
        paint=paint,
        paint_texels=paint_texels,
    )


def _lay_out(finishes: Sequence[Finish | None]) -> tuple[NDArray[np.float64], NDArray[np.int16]]:
    """Concatenate finishes: rows and texels as in `MaterialTable`."""
    rows, texels = np.full((len(finishes), 8), -1.0), [np.zeros((0, 3), np.int16)]
    for row, finish in zip(rows, finishes, strict=True):
        if finish is not None:
            height, width = finish.kelvin.shape
            first = sum(map(len, texels))
            row[:] = first, width, height, finish.lowest_m, 1.0 / finish.texel_m, *finish.rgb
            texels.append(finish.texels())
    return (rows if len(texels) > 1 else rows[:0]), np.concatenate(texels)


def make_paint_table(
    paintings: Sequence[Painting | None],
) -> tuple[NDArray[np.float64], NDArray[np.int16]]:
    """Convert the textures of all P parts to arrays.

    Returns:
        (P, 7) first texel (-1 for a part without a texture), unrolling, origin across and up [m], texels per
        metre, columns, rows; and (2, N) texels: temperature offset [K / 256], factor on light [1 / 4096].
        They are 16-bit integers for better use of the cache, since memory access takes longest.
    """
    rows = np.full((len(paintings), 7), -1.0)
    texels, first = [np.zeros((2, 0), np.int16)], 0
    for row, painting in zip(rows, paintings, strict=True):
        if painting is not None:
            height, width = painting.kelvin.shape
            row[:] = first, painting.unrolling, *painting.origin_m, 1.0 / painting.texel_m, width, height
            layers = np.stack([painting.kelvin.ravel(), painting.light.ravel()]) * _STEPS[:, None]
            texels.append(np.clip(np.rint(layers), -32768, 32767).astype(np.int16))
            first += height * width
    return rows, np.concatenate(texels, axis=1)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CameraView:
    """The view of one camera at an instant, with everything that image formation needs.

    Attributes:
        view: the rendered view.
        draw: renders the same with another geometry at the same pose.
        world_from_camera: (4, 4) optical frame to world.
        world_from_part: (P, 4, 4).
        materials: materials of the P parts.
        surroundings_c: [degC] temperature that surfaces reflect.
        light_level: light level; 1 is the place's full light.
        turn_rad_s: [rad/s] turn rate of the robot about the vertical axis.
        time_s: [s] time since the start.
        full_detail: extras for full detail; None in plain detail.
        glass_cosine: (H, W) cosine of the angle between each pixel's ray and the normal of the glass that it
            passes, NaN without glass; for depth cameras in places with glass, otherwise None.
    """

    view: View
    draw: Callable[[CameraGeometry], View]
    world_from_camera: Matrix
    world_from_part: Matrix
    materials: MaterialTable
    surroundings_c: float
    light_level: float
    turn_rad_s: float
    time_s: float
    full_detail: FullDetail | None = None
    glass_cosine: NDArray[np.float64] | None = None
