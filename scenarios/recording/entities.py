"""Where things are in a recording, and what is drawn on the cameras' images.

world/place/...             floor, walls and things; the ceiling is there, but not shown at first
world/place/moved/NAME      a thing that is moved, in a frame that goes with it
world/robot                 its pose; below it body and cameras, with what is drawn on their images:
world/robot/thermal/...     image, tracks with evidence, particles, truth
world/robot/colour/...      image, tracks, truth
world/robot/CAMERA/...      image, truth, and tracks if they have boxes there, of any further camera
world/robot/CAMERA/explained  what the tracker explains of that image: the empty scene, and lines
world/points/CAMERA         what a depth camera sees, as points with their colours
world/robot/places          where on the floor the tracker takes people to be, with 95 % ellipses
world/people/NAME/body      capsules, and the name
world/occlusions            arrows from who hides to who is hidden
world/trails                where robot and people went
curves/..., events          what the lower row of views shows
"""

from __future__ import annotations

from typing import Any, Final

import rerun as rr

THERMAL: Final = "world/robot/thermal"
COLOUR: Final = "world/robot/colour"
OCCLUSIONS: Final = "world/occlusions"
PLACES: Final = "world/robot/places"
TRAILS: Final = "world/trails"
EVENTS: Final = "events"

# What a layer on an image is made of, and its radius in points of the screen.
LAYERS: Final[dict[str, tuple[Any, float]]] = {
    "truth/boxes": (rr.Boxes2D, 0.6),
    "truth/names": (rr.Points2D, 0.0),
    "truth/occlusions": (rr.Arrows2D, 1.2),
    "tracks/boxes": (rr.Boxes2D, 1.0),
    "tracks/contours": (rr.LineStrips2D, 1.8),
    "tracks/occlusions": (rr.Arrows2D, 1.2),
    "explained/lines": (rr.LineStrips2D, 0.8),
    "particles/people": (rr.Points2D, 1.5),
    "particles/detector": (rr.Points2D, 1.5),
}
ON_COLOUR: Final = ("truth/boxes", "truth/names", "tracks/boxes")
ON_FURTHER: Final = ("truth/boxes", "truth/names", "tracks/boxes", "explained/lines")
BACKGROUND: Final = "explained/background"


def camera_path(name: str) -> str:
    """Give the entity of a camera."""
    return f"world/robot/{name}"


def points_path(camera: str) -> str:
    """Give the entity of the points that a depth camera sees."""
    return f"world/points/{camera}"


def thing_path(name: str) -> str:
    """A thing that is moved."""
    return f"world/place/moved/{rr.escape_entity_path_part(name)}"


def person_path(name: str) -> str:
    """Give the entity of a person."""
    return f"world/people/{rr.escape_entity_path_part(name)}"
