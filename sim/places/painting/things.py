"""How things stand out from their temperature: warmer above than below, uneven, worn."""

from __future__ import annotations

from peopleboy.sim.places.painting.fresco import Fresco
from peopleboy.sim.shapes.materials import Material


def paint_thing(fresco: Fresco, material: Material) -> None:
    """Give a thing its gradient and its unevenness."""
    fresco.kelvin += material.gradient_k_per_m * (fresco.up - 0.5 * fresco.size[1])
    scale = min(max(0.3 * max(fresco.size), 0.1), 1.5)
    fresco.kelvin += max(material.uneven_k, 0.25) * fresco.cloudy(scale)
    fresco.light *= 1.0 + 0.03 * fresco.cloudy(scale)
