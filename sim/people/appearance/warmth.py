"""How warm skin and clothes are in air of any temperature.

A garment's surface lies between air and skin: T = air + (skin - air) * r. By the heat that goes through the
cloth and on from its surface, r = 1 / (1 + h R) with h [W / (m2 K)] of the surface and R [m2 K / W] of the
cloth (ISO 7730:2005, clause 4.1, solved for the surface). The catalogue gives T in air of 21 degC and by that
each garment's r, so that there all is as the catalogue says.
"""

from __future__ import annotations

import numpy as np

ROOM_C = 21.0  # air of the catalogue's temperatures
WARMEST_SKIN_C = 36.8
_COVERED_SKIN_C = 33.4  # skin under clothes, in air of 21 degC
_BY_RADIATION, _IN_A_ROOM = 4.5, 8.5  # W / (m2 K); in a room convection has the rest
_LEAST, _MOST = 0.2, 0.95  # of r: a warm shoe, a stocking

# [K] how much colder or warmer skin is than in air of 21 degC, in air of _AIR_C: an hour in still air of 50 %
# humidity, standing, at twice the basal metabolism, in clothes of 0.7 clo, of 1.2 clo at 15 degC, up to
# 2.2 clo at -5 degC. Run with JOS-3 0.5 (Takahashi et al. 2021, Energy and Buildings 231, 110575), one man.
_AIR_C = (-5.0, 5.0, 10.0, 15.0, 21.0, 25.0, 30.0, 35.0, 40.0)
_SKIN_K = {
    "head": (-4.9, -3.6, -2.7, -1.6, 0.0, 1.3, 2.2, 2.7, 3.3),
    "neck": (-6.7, -4.2, -2.9, -1.6, 0.0, 1.0, 1.9, 2.5, 3.0),
    "hand": (-15.9, -7.2, -4.3, -2.0, 0.0, 0.9, 1.6, 2.0, 2.5),
    "arm": (-7.1, -5.5, -3.7, -1.9, 0.0, 0.9, 1.5, 2.0, 2.6),
    "leg": (-3.6, -2.8, -2.3, -1.4, 0.0, 0.8, 1.3, 1.5, 2.4),
    "foot": (-4.4, -3.8, -3.4, -1.6, 0.0, 0.6, 0.9, 1.0, 1.6),
    "trunk": (-2.7, -2.1, -1.7, -1.1, 0.0, 0.3, 0.4, 1.4, 2.7),
}
_REGION = {
    "head": "head", "hair": "head", "neck": "neck", "hand": "hand", "forearm": "arm", "upper_arm": "arm",
    "foot": "foot", "shin": "leg", "thigh": "leg",
}  # fmt: skip


def skin_change_k(part: str, air_c: float) -> float:
    """Return by how much the skin of a part [K] differs in such air from what it is at 21 degC."""
    bare = part.removeprefix("left_").removeprefix("right_")
    return float(np.interp(air_c, _AIR_C, _SKIN_K[_REGION.get(bare, "trunk")]))


def bare_c(at_room_c: float, part: str, air_c: float) -> float:
    """Return the temperature [degC] of skin that has another one in air of 21 degC."""
    return min(at_room_c + skin_change_k(part, air_c), max(WARMEST_SKIN_C, at_room_c))


def share_of_skin(at_room_c: float) -> float:
    """Return r of a garment that has this temperature [degC] in air of 21 degC."""
    return min(max((at_room_c - ROOM_C) / (_COVERED_SKIN_C - ROOM_C), _LEAST), _MOST)


def under_cloth_c(part: str, air_c: float) -> float:
    """Return the temperature [degC] of skin that clothes cover."""
    return bare_c(_COVERED_SKIN_C, part, air_c)


def wind_loss(moving_m_s: float) -> float:
    """How many times as much heat a surface loses in air that moves so fast against it [m/s] as in a room.

    Source: ISO 7730:2005, clause 4.1: 12.1 W / (m2 K) by convection at 1 m/s, which grows with the root of
    speed; 4.5 W / (m2 K) by radiation.
    """
    return max((12.1 * float(np.sqrt(moving_m_s)) + _BY_RADIATION) / _IN_A_ROOM, 1.0)


def cloth_c(at_room_c: float, part: str, air_c: float, loss: float = 1.0) -> float:
    """Return the temperature [degC] of a garment's surface that has another one in still air of 21 degC.

    Args:
        at_room_c: [degC] that one.
        part: what it covers.
        air_c: [degC] of the air.
        loss: how many times as much heat the surface loses as in a room: r = 1 / (1 + loss h R).
    """
    r = share_of_skin(at_room_c)
    return air_c + (under_cloth_c(part, air_c) - air_c) * r / (r + loss * (1.0 - r))
