"""How scenarios are run: by which tracker and behaviour, and what is kept."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from peopleboy.tracker.footage.box_kinds import BoxKind

if TYPE_CHECKING:
    from peopleboy.scenarios.files.scenario import Scenario


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions:
    """How to run a scenario.

    Suites, sweeps and comparisons take the same, and choose `seed` and `out` for each of their runs.

    Attributes:
        viewer: address of a viewer that shows the recording while it is made; None for none.
    """

    seed: Annotated[int, Field(ge=0, description="Seed of everything random.")]
    out: Annotated[Path, Field(description="Folder of the run.")]
    frames: Annotated[bool, Field(description="Write every image of every camera as PNG too.")] = False
    tracker: Annotated[str | None, Field(description="Tracker that the robot sees people by.")] = None
    boxes: Annotated[
        BoxKind,
        Field(
            description="What the tracker's boxes enclose, and the truth's by which they are scored: the "
            "torso, or the whole person, as most detectors do."
        ),
    ] = BoxKind.TORSO
    behaviour: Annotated[str | None, Field(description="Behaviour that drives the robot.")] = None
    physics: Annotated[
        Literal["bullet", "kinematic"] | None,
        Field(
            description="What moves the robot: PyBullet, or rolling without slip, which needs no PyBullet.  "
            "[default: the scenario's]"
        ),
    ] = None
    renderer: Annotated[str, Field(description="raycast, or bullet (slow reference).")] = "raycast"
    record: Annotated[bool, Field(alias="no_rrd", description="Write no rerun recording.")] = True
    lossless: Annotated[
        bool,
        Field(
            description="Keep the recording's images as they are, in 12 times the space; else they are JPEG "
            "of quality 45."
        ),
    ] = False
    viewer: str | None = None
    overwrite: Annotated[bool, Field(description="Replace an earlier run in the folder.")] = False

    def applied_to(self, scenario: Scenario) -> Scenario:
        """Return a scenario with the behaviour and the physics that are asked for.

        Raises:
            BadInput: there is no such behaviour.
        """
        steered = scenario if self.behaviour is None else scenario.steered_by(self.behaviour)
        return steered if self.physics is None else steered.moved_by(self.physics)
