"""Colours that are distinct with any colour vision, on grey images and on dark plots."""

from typing import Final

Rgb = tuple[int, int, int]

# Okabe and Ito, "Color Universal Design" (2008), without black and blue, invisible on dark images.
_TRACKS: Final[tuple[Rgb, ...]] = (
    (230, 159, 0),
    (86, 180, 233),
    (0, 158, 115),
    (240, 228, 66),
    (213, 94, 0),
    (204, 121, 167),
)
# Paul Tol, "Colour Schemes" (2021), light: paler than the colours of tracks, to avoid confusion.
_PEOPLE: Final[tuple[Rgb, ...]] = (
    (153, 221, 255),
    (238, 221, 136),
    (255, 170, 187),
    (187, 204, 51),
    (119, 170, 221),
    (238, 136, 102),
    (68, 187, 153),
)

TRACK_COLOURS: Final = len(_TRACKS)  # the colours repeat after this many tracks
TRUTH: Final[Rgb] = (150, 240, 130)
ROBOT: Final[Rgb] = (214, 69, 65)


def track_colour(number: int) -> Rgb:
    """Return the colour of a track by its id; colours repeat after six."""
    return _TRACKS[(number - 1) % TRACK_COLOURS]


def person_colour(number: int) -> Rgb:
    """Return the colour of a person by id; colours repeat after seven."""
    return _PEOPLE[(number - 1) % len(_PEOPLE)]


def faded(colour: Rgb, share: float) -> Rgb:
    """Mix a colour with black: 1 returns the colour, 0 black."""
    red, green, blue = colour
    return round(red * share), round(green * share), round(blue * share)


def paled(colour: Rgb, share: float) -> Rgb:
    """Mix a colour with white: 1 returns the colour, 0 white."""
    red, green, blue = colour
    return (
        round(255 - (255 - red) * share),
        round(255 - (255 - green) * share),
        round(255 - (255 - blue) * share),
    )
