"""The whole file."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from peopleboy.scenarios.files.schema.people import GroupSpec, PersonSpec
from peopleboy.scenarios.files.schema.place import PlaceSpec
from peopleboy.scenarios.files.schema.robot import FaultSpec, RobotSpec
from peopleboy.scenarios.files.schema.things import ThingSpec
from peopleboy.scenarios.files.schema.values import Key, Seconds, Strict
from peopleboy.sim.physics.physics import PhysicsName
from peopleboy.sim.shapes.materials import Detail


class LightSpec(Strict):
    """From a time on, the room's light has a level."""

    at_s: Seconds = Field(description="when the light changes")
    level: float = Field(ge=0.0, le=2.0, description="0 is dark, 1 is full light")


class DrawnSpec(Strict):
    """In a run's folder: what everything was drawn from."""

    seed: int = Field(ge=0, description="of the run")
    versions: dict[str, str] = Field(default={}, description="of the packages on which the bytes depend")
    drive: Literal["drive.parquet"] | None = Field(
        default=None,
        description="commands that the robot repeats, in a file beside this one, whatever its behaviour is",
    )


class ScenarioSpec(Strict):
    """A scenario file."""

    name: Key = Field(description="one word, for folders")
    description: str = Field(
        min_length=1,
        max_length=1000,
        description="what happens, in a sentence or two; `peopleboy list` prints it",
    )
    like: Key | None = Field(
        default=None,
        description="a scenario of the library, whose keys stand in for those that this file leaves out",
    )
    duration_s: float = Field(gt=0.0, le=36000.0, description="how long a run lasts")
    place: PlaceSpec = Field(description="the room or corridor")
    things: tuple[ThingSpec, ...] = Field(
        default=(), strict=False, max_length=300, description="what stands or hangs there, warm or cold"
    )
    people: tuple[PersonSpec, ...] = Field(
        default=(), strict=False, max_length=60, description="who walks through the place"
    )
    groups: tuple[GroupSpec, ...] = Field(
        default=(), strict=False, max_length=20, description="people who walk side by side"
    )
    clothes_differ: bool = Field(
        default=False,
        description="whether the seed draws clearly different colours where the file leaves them out",
    )
    detail: Detail = Field(
        default="plain",
        description="how finely people and surfaces are drawn: `full` is nearer to real images, "
        "`plain` is quicker and keeps the bytes of older files",
    )
    physics: PhysicsName = Field(
        default="bullet",
        description="what moves the robot: `bullet` has the dynamics of PyBullet, which must be installed; "
        "`kinematic` lets it roll without slip, needs no PyBullet and is quicker",
    )
    lights: tuple[LightSpec, ...] = Field(
        default=(),
        strict=False,
        description="steps of the room's light, in the order of time; left out, it is full light",
    )
    robot: RobotSpec = Field(description="where it starts and what it does")
    faults: tuple[FaultSpec, ...] = Field(
        default=(), strict=False, max_length=50, description="what breaks, to try a controller"
    )
    drawn: DrawnSpec | None = Field(default=None, description="only in the file that a run leaves behind")


def json_schema() -> dict[str, Any]:
    """The JSON schema of scenario files, for editors; a file that is like another may leave keys out."""
    schema = ScenarioSpec.model_json_schema()
    required = schema.pop("required")
    return schema | {"anyOf": [{"required": required}, {"required": ["name", "description", "like"]}]}
