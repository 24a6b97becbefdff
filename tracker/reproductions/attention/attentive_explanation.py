"""State of the attentive tracker, for plots and recordings."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.reproductions.attention.attend import Focus, PersonModel, learn, search
from peopleboy.tracker.reproductions.attention.attention_config import AttentionConfig
from peopleboy.tracker.reproductions.attention.image_sums import ImageSums
from peopleboy.tracker.reproductions.attention.person_views import PersonView

TRACKING_ATTENTION: Final = AttentionConfig(scales=(0.64, 0.8, 1.0, 1.25, 1.56))


@dataclass(frozen=True, slots=True, eq=False)
class Attended:
    """A learned person, and the newest image.

    Attributes:
        number: id of the person.
        camera: whose images are searched.
        look: the learned appearance model.
        image: (H, W, 3) RGB.
    """

    number: int
    camera: str
    model: PersonModel
    image: NDArray[np.uint8]

    @classmethod
    def learned(cls, number: int, view: PersonView) -> "Attended":
        """Learn a person from one image."""
        model = learn(ImageSums.of(view.image, TRACKING_ATTENTION), view.box, TRACKING_ATTENTION)
        return cls(number, view.camera, model, view.image)

    def focus(self) -> Focus:
        """Search the newest image, independently of tracks; this takes about ten milliseconds."""
        return search(ImageSums.of(self.image, TRACKING_ATTENTION), self.model, TRACKING_ATTENTION)


@dataclass(frozen=True, slots=True, eq=False)
class AttentiveExplanation:
    """Explanation of the wrapped tracker, and similarity of people to their identities.

    Attributes:
        below: explanation of the wrapped tracker, by track id.
        likeness: 0..1, recent mean score of sufficiently visible people, by id.
        attended: the first learned person in the newest colour image; None before, or without a colour
            camera.
    """

    below: object
    likeness: Mapping[int, float]
    attended: Attended | None

    @property
    def parts(self) -> tuple[object, ...]:
        """The wrapped tracker's explanation."""
        return (self.below,)
