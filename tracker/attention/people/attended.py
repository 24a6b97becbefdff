"""The person on whom attention is, for those who want to look over the tracker's shoulder."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.attention.attend import Focus, PersonLook, learn, search
from peopleboy.tracker.attention.attention_config import AttentionConfig
from peopleboy.tracker.attention.people.views import View
from peopleboy.tracker.attention.sight import Sight

LOOK: Final = AttentionConfig(scales=(0.64, 0.8, 1.0, 1.25, 1.56))


@dataclass(frozen=True, slots=True, eq=False)
class Attended:
    """A person who was learned, and the newest image.

    Attributes:
        number: of the person.
        camera: in whose images it is looked for.
        look: as it looked when it was learned.
        image: (H, W, 3) RGB.
    """

    number: int
    camera: str
    look: PersonLook
    image: NDArray[np.uint8]

    @classmethod
    def learned(cls, number: int, view: View) -> Attended:
        """Learn somebody from one image."""
        look = learn(Sight.of(view.image, LOOK), view.box, LOOK)
        return cls(number, view.camera, look, view.image)

    def focus(self) -> Focus:
        """Look for the person in the newest image, wherever tracks are; this takes some ten milliseconds."""
        return search(Sight.of(self.image, LOOK), self.look, LOOK)
