"""Units of work that draw pictures of films."""

from __future__ import annotations

from dataclasses import dataclass

from peopleboy.scenarios.running.engine.store import Result


@dataclass(frozen=True, slots=True)
class PictureUnit:
    """A picture, as the address of a page's image.

    Attributes:
        name: id of the experiment.
    """

    name: str
    is_timing: bool = False

    @property
    def key(self) -> str:
        """Which one."""
        return f"picture {self.name}"

    def run(self) -> Result:
        """Film what it needs, and draw it."""
        # Here, as these need PyBullet.
        from peopleboy.studies.reproductions.pictures.canvas import png_address
        from peopleboy.studies.reproductions.pictures.drawn_again import DRAWN

        return {"picture": png_address(DRAWN[self.name]())}
