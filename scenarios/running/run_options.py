"""Options of a run: seed, tracker, behaviour, physics, and the files to write."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from peopleboy.scenarios.run_folder.frame_choice import FrameChoice
from peopleboy.tracker.footage.box_kinds import BoxKind

if TYPE_CHECKING:
    from peopleboy.scenarios.files.scenario import Scenario


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions:
    """How to run a scenario.

    Suites, sweeps and comparisons use the same options, and set `seed` and `out` for each run.

    Attributes:
        viewer: address of a viewer that shows the recording during the run; None for none.
        choice: frames whose images and ground truth are written; None for a run with all frames.
    """

    seed: Annotated[int, Field(ge=0, description="Random seed.")]
    out: Annotated[Path, Field(description="Output folder.")]
    frames: Annotated[bool, Field(description="Write the images of all cameras as PNG files.")] = False
    tracker: Annotated[str | None, Field(description="Tracker.")] = None
    detector: Annotated[str | None, Field(description="Detector of the tracker.")] = None
    gallery: Annotated[
        Path | None,
        Field(
            description="File of the people that the tracker knows; it is read before the run if it exists, "
            "and written after it. A person from an earlier run keeps the id."
        ),
    ] = None
    boxes: Annotated[
        BoxKind,
        Field(
            description="What the tracker's boxes enclose: the torso, or the whole person, as for most "
            "detectors. Scoring uses ground-truth boxes of the same kind."
        ),
    ] = BoxKind.TORSO
    behaviour: Annotated[str | None, Field(description="Behaviour that drives the robot.")] = None
    physics: Annotated[
        Literal["bullet", "kinematic"] | None,
        Field(
            description="Physics engine: bullet uses PyBullet; kinematic assumes rolling without slip "
            "and does not need PyBullet.  [default: the scenario's]"
        ),
    ] = None
    renderer: Annotated[str, Field(description="Renderer: raycast, or bullet as a slow reference.")] = (
        "raycast"
    )
    record: Annotated[bool, Field(alias="no_recording", description="Do not write a rerun recording.")] = True
    lossless: Annotated[
        bool,
        Field(
            description="Store the recording's images losslessly, which takes 12 times the space. "
            "Without this option, they are JPEG with quality 45."
        ),
    ] = False
    viewer: str | None = None
    choice: FrameChoice | None = None
    overwrite: Annotated[bool, Field(description="Replace an earlier run in the output folder.")] = False

    def applied_to(self, scenario: "Scenario") -> "Scenario":
        """Return a scenario with the behaviour and the physics of these options.

        Raises:
            BadInput: the behaviour or the physics are unknown.
        """
        steered = scenario if self.behaviour is None else scenario.steered_by(self.behaviour)
        return steered if self.physics is None else steered.moved_by(self.physics)
