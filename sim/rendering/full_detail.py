"""What makes images of full detail of a view: edges, mirrors, and what touches the floor."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.rendering.contacts import Contacts, find_contacts
from peopleboy.sim.rendering.edges import smooth
from peopleboy.sim.rendering.reflections import Reflection, find_reflections
from peopleboy.sim.rendering.sight import Seen


class FullDetail:
    """What goes beyond one point a pixel in what a pinhole camera sees, each found when first asked for.

    Args:
        seen: what it sees.
        camera: its geometry.
        is_shiny: (P,) parts that mirror.
        is_mirrored: (P,) parts that are seen in mirrors.
    """

    def __init__(
        self, seen: Seen, camera: Pinhole, is_shiny: NDArray[np.bool_], is_mirrored: NDArray[np.bool_]
    ) -> None:
        self._seen, self._camera = seen, camera
        self._is_shiny, self._is_mirrored = is_shiny, is_mirrored

    def smooth(self, image: NDArray[np.float32], contrast: float) -> None:
        """Give the edges of an (H, W, C) image of this view no stairs, in place; see `edges.smooth`."""
        seen = self._seen
        smooth(
            image, contrast, seen.view, seen.scene.table, self._camera, seen.world_from_camera,
            seen.scene.world_from_part,
        )  # fmt: skip

    @cached_property
    def reflections(self) -> tuple[Reflection, ...]:
        """What is mirrored in what is seen."""
        return find_reflections(self._seen, self._camera, self._is_shiny, self._is_mirrored)

    @cached_property
    def contacts(self) -> Contacts:
        """What stands on the floor."""
        scene = self._seen.scene
        return find_contacts(scene.table, scene.world_from_part, scene.hidden)
