"""Who or what is seen at each pixel, and what is true of the things that are moved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.places.moving import Mover
from peopleboy.sim.truth.truth import Box, box_of_pixels

NOTHING = -1


@dataclass(frozen=True, slots=True, eq=False)
class Owners:
    """Whose every pixel of an image is; nothing is computed until it is asked for.

    Attributes:
        names: of people, things, walls and the robot.
        of_part: (P + 1,) number of the name of each part's owner; the last one for no part.
        part: (H, W) number of the part seen, -1 for none.
    """

    names: tuple[str, ...]
    of_part: NDArray[np.int16]
    part: NDArray[np.int32]

    def image(self) -> NDArray[np.int16]:
        """(H, W) number in `names` of who or what is seen, -1 for nothing."""
        return np.asarray(self.of_part[self.part])

    def mask(self, *names: str) -> NDArray[np.bool_]:
        """(H, W) where one of these is seen; of names that nobody has, nowhere."""
        wanted = np.isin(np.array([*self.names, ""]), names)
        return np.asarray(wanted[self.of_part][self.part])


@dataclass(frozen=True, slots=True, kw_only=True)
class ThingTruth:
    """All that is true of one moved thing at one instant.

    Attributes:
        name: as in the scenario.
        position_m: (x, y, z) of its frame, world frame: z is the height of its foot. Of what is not there,
            where it was last, or will appear.
        heading_rad: [rad] where its front looks.
        is_there: whether it is in the place.
        is_moving: whether something moves it.
        moved_by: name of the person who does, or did last; None for nobody.
        visible_px: pixels in which it is what the camera sees.
        visible_box: left, top, width, height [px] of those pixels; None without any.
    """

    name: str
    position_m: tuple[float, float, float]
    heading_rad: float
    is_there: bool
    is_moving: bool
    moved_by: str | None
    visible_px: int
    visible_box: Box | None


def things_truth(movers: Sequence[Mover], time_s: float, owners: Owners) -> tuple[ThingTruth, ...]:
    """Tell what is true of all things that are moved, as one camera sees them."""
    if not movers:
        return ()
    image = owners.image()
    return tuple(_thing(mover, time_s, image == owners.names.index(mover.name)) for mover in movers)


def _thing(mover: Mover, time_s: float, seen: NDArray[np.bool_]) -> ThingTruth:
    state = mover.at(time_s)
    return ThingTruth(
        name=mover.name,
        position_m=state.stance.position_m,
        heading_rad=float(np.remainder(state.stance.heading_rad + np.pi, 2.0 * np.pi) - np.pi),
        is_there=state.is_there,
        is_moving=state.is_moving,
        moved_by=state.by,
        visible_px=int(np.count_nonzero(seen)),
        visible_box=_box(seen),
    )


def _box(seen: NDArray[np.bool_]) -> Box | None:
    columns, rows = np.flatnonzero(seen.any(axis=0)), np.flatnonzero(seen.any(axis=1))
    if not len(rows):
        return None
    return box_of_pixels(*(float(edge) for edge in (columns[0], columns[-1], rows[0], rows[-1])))
