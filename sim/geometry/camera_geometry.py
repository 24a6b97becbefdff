"""What all cameras' geometries tell, whatever the shape of what they project onto."""

from __future__ import annotations

from dataclasses import Field
from typing import Any, ClassVar, Protocol

from peopleboy.sim.geometry.pinhole import Matrix


class CameraGeometry(Protocol):
    """Size and place of a camera, and where in its image a point falls.

    It is a frozen dataclass with the fields `width` and `height`. Image and optical frame are as in
    `Pinhole`; who needs more, such as a focal length, asks for a `Pinhole`.
    """

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]

    @property
    def width(self) -> int:
        """[px] columns of the image."""
        ...

    @property
    def height(self) -> int:
        """[px] rows of the image."""
        ...

    @property
    def robot_from_camera(self) -> Matrix:
        """(4, 4) optical frame to robot frame; read-only."""
        ...

    def project(self, camera_points: Matrix) -> Matrix:
        """Project (..., 3) points [m] of the optical frame: (..., 2) [px] u, v; NaN where none is."""
        ...

    def __hash__(self) -> int:
        """Equal geometries see the same, which is drawn once."""
        ...
