"""How the robot's own surfaces look, should a camera see them."""

from __future__ import annotations

from peopleboy.sim.shapes.materials import Material

_BODY = Material(temperature_c=26.0, emissivity=0.9, variation_k=0.8, variation_m=0.4, rgb=(0.45, 0.04, 0.05))
_WHEEL = Material(temperature_c=22.0, rgb=(0.04, 0.04, 0.045))


def robot_material(link_name: str) -> Material:
    """Return the look of one link of the robot: warm electronics in the body, cool wheels."""
    return _WHEEL if "wheel" in link_name or "caster" in link_name else _BODY
