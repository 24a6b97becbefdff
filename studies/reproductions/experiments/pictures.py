"""Figures that are pictures: of thermal contours and tracks, of the 2003 paper, and of attention."""

from __future__ import annotations

from dataclasses import dataclass

from peopleboy.studies.reproductions.experiments.experiment import Chart, Done, Samples, missing
from peopleboy.studies.reproductions.measuring.picture_units import PictureUnit
from peopleboy.studies.reproductions.measuring.units import Unit
from peopleboy.studies.reproductions.measuring.workload import Plan


@dataclass(frozen=True, slots=True)
class Depiction:
    """A figure without numbers, drawn again.

    Attributes:
        id: as `experiment.Experiment` says.
    """

    id: str
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:  # noqa: ARG002
        """The picture."""
        return missing([PictureUnit(self.id)], done)

    def samples(self, plan: Plan, done: Done) -> Samples:  # noqa: ARG002
        """Give nothing: the figure has no numbers."""
        return {}

    def picture(self, plan: Plan, done: Done) -> str:  # noqa: ARG002
        """Give the picture's address."""
        address: str = done[PictureUnit(self.id).key]["picture"]
        return address


DEPICTIONS = (
    *(Depiction(f"panoramic-figure-{number}") for number in range(1, 5)),
    *(Depiction(f"situation-figure-5.{number}") for number in (6, 7, 8, 9)),
)
