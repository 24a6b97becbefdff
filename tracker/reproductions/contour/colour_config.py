"""Settings of the description of a person's colours."""

import math
from dataclasses import dataclass

from peopleboy.bad_input import BadInput

# Checks of settings.


def check_positive(config: object, *names: str) -> None:
    """Refuse a record in which one of the named values is not positive."""
    for name in names:
        refuse_unless(getattr(config, name) > 0, config, name, "positive")


def check_share(config: object, *names: str) -> None:
    """Refuse a record in which one of the named values is not in 0..1."""
    for name in names:
        refuse_unless(0 <= getattr(config, name) <= 1, config, name, "in 0..1")


def check_not_negative(config: object, *names: str) -> None:
    """Refuse a record in which one of the named values is negative."""
    for name in names:
        refuse_unless(getattr(config, name) >= 0, config, name, "0 or more")


def refuse_unless(is_right: bool, config: object, name: str, rule: str) -> None:
    """Refuse a record in which the named value violates a rule."""
    if not is_right:
        raise BadInput(f"{type(config).__name__}: {name} must be {rule}, got {getattr(config, name)}")


Affine = tuple[float, float, float, float, float, float]

THESIS_AFFINE: Affine = (-0.15, 1.20, 0.0, -0.13, 0.0, 1.20)
"""Equation 6.1 as given in the thesis, for its own pair of cameras."""

ROBOT_AFFINE: Affine = (-0.0885, 1.20, 0.0, -0.1, 0.0, 1.20)
"""Equation 6.1 for the simulated robot: a colour camera 6 cm to the left, with a view narrower by 1.2.

The shift is best on average over people 3 to 10 m away; nearer and farther ones are off by up to 1 % of the
image's width.
"""

FAR_AFFINE: Affine = (-0.1, 1.20, 0.0, -0.1, 0.0, 1.20)
"""The same for distant objects; with a `parallax` it holds for people at every distance."""

SAME_VIEW: Affine = (0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
"""For a picture aligned with the thermal image."""

ROBOT_PARALLAX = 0.147
"""Shift of a person per semi-height h: 1.2 times 6 cm, over the 49 cm that h is of a person of 1.72 m."""

REPRESENTATIONS = {"moments1": 1, "moments2": 2, "moments3": 3, "histogram": 0}
"""Colour representations, and the number of moments of each."""

SPACES = {"rgb": 3, "grey": 1, "hsv": 3}
"""Colour spaces, and the number of channels of each."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ColourDescriptorConfig:
    """How the colours of a person are described, stored and compared.

    Attributes:
        affine: p1 to p6, which map a position (u, v) in the thermal image to (x, y) = (p1 + p2 u + p3 v,
            p4 + p5 u + p6 v) in the colour image, all as shares of the image width and height. The thesis
            does not state the unit, but its numbers are plausible as shares only.
        parallax: additional shift of x, divided by a person's semi-height h, as a share of the thermal
            image's width. People who are near, and therefore tall in the image, are shifted more. In the
            thesis, it is 0.
        representation: "moments1" to "moments3" or "histogram", for every part and channel.
        space: "rgb", "grey" or "hsv".
        frames: n_k, the number of descriptions in the model.
        sharpness: lambda of the likelihood.

    Raises:
        BadInput: a name is unknown, or a value is out of range.

    Source: thesis, sections 6.1 and 6.3.
    """

    affine: Affine = ROBOT_AFFINE
    parallax: float = 0.0
    representation: str = "moments3"
    space: str = "rgb"
    frames: int = 10
    sharpness: float = 50.0

    def __post_init__(self) -> None:
        check_positive(self, "frames")
        check_not_negative(self, "sharpness")
        _check_name("representation", self.representation, REPRESENTATIONS)
        _check_name("space", self.space, SPACES)
        _check_affine(self.affine)
        if not math.isfinite(self.parallax):
            raise BadInput(f"ColourConfig: parallax must be a finite number, got {self.parallax}")


def _check_name(key: str, name: str, known: dict[str, int]) -> None:
    if name not in known:
        raise BadInput(f"ColourConfig: unknown {key} {name!r}; choose from {', '.join(known)}")


def _check_affine(affine: Affine) -> None:
    if len(affine) != 6 or not all(math.isfinite(p) for p in affine):
        raise BadInput(f"ColourConfig: affine must be 6 finite numbers, got {affine}")
    if not (affine[1] > 0 and affine[5] > 0):
        raise BadInput(f"ColourConfig: affine must not mirror, p2 and p6 must be positive, got {affine}")
