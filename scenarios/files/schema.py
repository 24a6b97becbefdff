"""What a scenario file may say: every key with its unit, its limits and its default.

Lengths in metres, angles in degrees, times in seconds, temperatures in degC: the key's last letters say so.
x points forward from where the place begins, y to the left; headings count from x to the left.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag

from peopleboy.sim.people.body.clothes import BOTTOMS, COLOURS, HAIR, SHOES, TOPS
from peopleboy.sim.places.things import KINDS

Coordinate = Annotated[float, Field(ge=-1000.0, le=1000.0)]
Point = Annotated[tuple[Coordinate, Coordinate], Field(strict=False)]
Seconds = Annotated[float, Field(ge=0.0, le=36000.0)]
Degrees = Annotated[float, Field(ge=-720.0, le=720.0)]
Celsius = Annotated[float, Field(ge=-40.0, le=400.0)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Extent = Annotated[float, Field(ge=0.005, le=100.0)]
Rgb = Annotated[tuple[Share, Share, Share], Field(strict=False)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_-]{0,39}$")]
Key = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,59}$")]


def _word_or_list(value: Any) -> str:
    return "word" if isinstance(value, str) else "list"


ColourName = Literal[*COLOURS]  # type: ignore[valid-type]
Colour = Annotated[
    Annotated[ColourName, Tag("word")] | Annotated[Rgb, Tag("list")], Discriminator(_word_or_list)
]
Face = Annotated[Annotated[Name, Tag("word")] | Annotated[Point, Tag("list")], Discriminator(_word_or_list)]


class Strict(BaseModel):
    """Refuses unknown keys, numbers written as text, NaN and infinity."""

    model_config = ConfigDict(
        strict=True,
        extra="forbid",
        frozen=True,
        allow_inf_nan=False,
        use_attribute_docstrings=True,
    )


class DoorSpec(Strict):
    """A door in a wall. An open one leads to a small lobby, in which people wait out of sight."""

    wall: Key
    """name of the wall: north, south, east or west; in L and T corridors after the leg, as in first_north"""
    along_m: Coordinate
    """middle of the door: world x in a north or south wall, world y in an east or west wall"""
    width_m: Annotated[float, Field(ge=0.7, le=4.0)] = 0.95
    height_m: Annotated[float, Field(ge=1.9, le=3.0)] = 2.05
    open: bool = True
    """a closed door is a leaf on the wall, with nothing behind"""
    lobby_m: Annotated[float, Field(ge=1.0, le=6.0)] = 1.5
    """depth of the lobby behind an open door"""


class TemperaturesSpec(Strict):
    """Surface temperatures of the place itself."""

    floor_c: Celsius = 20.0
    ceiling_c: Celsius = 22.8
    walls_c: Celsius = 21.5
    single_walls_c: dict[Key, Celsius] = {}
    """walls that differ, by name, such as an outer wall in winter"""
    surroundings_c: Celsius = 21.0
    """what surfaces of low emissivity mirror"""


class ColoursSpec(Strict):
    """Colours of the place itself: names, or linear red, green and blue from 0 to 1."""

    floor: Colour | None = None
    ceiling: Colour | None = None
    walls: Colour | None = None
    doors: Colour | None = None


class _AnyPlace(Strict):
    width_m: Annotated[float, Field(ge=1.2, le=60.0)]
    height_m: Annotated[float, Field(ge=2.2, le=8.0)] = 2.7
    doors: Annotated[tuple[DoorSpec, ...], Field(strict=False)] = ()
    temperatures: TemperaturesSpec = TemperaturesSpec()
    colours: ColoursSpec = ColoursSpec()


Length = Annotated[float, Field(ge=1.5, le=100.0)]


class RoomSpec(_AnyPlace):
    """A rectangular room: x from 0 to length, y to half the width on either side."""

    kind: Literal["room"]
    length_m: Length


class CorridorSpec(_AnyPlace):
    """A straight corridor: x from 0 to length, y to half the width on either side."""

    kind: Literal["corridor"]
    length_m: Length


class LCorridorSpec(_AnyPlace):
    """A corridor along x from 0 whose end turns aside."""

    kind: Literal["l_corridor"]
    first_m: Length
    """length of the first leg, with the corner"""
    second_m: Length
    """length of the second leg beyond the first one's side"""
    turn: Literal["left", "right"] = "left"


class TCorridorSpec(_AnyPlace):
    """A corridor along x from 0 that ends in the middle of a corridor along y."""

    kind: Literal["t_corridor"]
    stem_m: Length
    bar_m: Length


PlaceSpec = Annotated[RoomSpec | CorridorSpec | LCorridorSpec | TCorridorSpec, Field(discriminator="kind")]


class PatternSpec(Strict):
    """A two-coloured pattern."""

    kind: Literal["plain", "stripes", "checks", "patch", "speckle"]
    period_m: Annotated[float, Field(ge=0.01, le=10.0)] = 0.1


class ThingSpec(Strict):
    """A thing that stands on the floor, on another thing, or on a wall."""

    kind: Literal[*KINDS, "urdf"]  # type: ignore[valid-type]
    name: Name | None = None
    """defaults to the kind and a number, such as radiator_1"""
    at_m: Point | None = None
    """where it stands; not together with wall"""
    wall: Key | None = None
    """the wall that it hangs on or stands against"""
    along_m: Coordinate | None = None
    """where along that wall: world x of a north or south wall, world y of an east or west wall"""
    on_top_of: Name | None = None
    """name of the thing that it stands on"""
    base_m: Annotated[float, Field(ge=0.0, le=8.0)] | None = None
    """height of its foot, where the kind's own will not do"""
    facing_deg: Degrees = 0.0
    """where its front looks; a thing on a wall looks into the place"""
    size_m: Annotated[tuple[Extent, Extent, Extent], Field(strict=False)] | None = None
    """depth, width, height"""
    temperature_c: Celsius | None = None
    emissivity: Annotated[float, Field(gt=0.0, le=1.0)] = 0.93
    colour: Colour | None = None
    pattern: PatternSpec = PatternSpec(kind="plain")
    urdf: Annotated[str, Field(min_length=1, max_length=200)] | None = None
    """of kind urdf: a file of pybullet_data, or one in the scenario file's own folder"""
    scale: Annotated[float, Field(ge=0.001, le=1000.0)] = 1.0


class ClothesSpec(Strict):
    """What a person wears; what is left out is drawn from the seed."""

    top: Literal[*TOPS] | None = None  # type: ignore[valid-type]
    bottom: Literal[*BOTTOMS] | None = None  # type: ignore[valid-type]
    shoes: Literal[*SHOES] | None = None  # type: ignore[valid-type]
    hair: Literal[*HAIR] | None = None  # type: ignore[valid-type]
    top_colour: Colour | None = None
    bottom_colour: Colour | None = None
    hair_colour: Colour | None = None


class WaypointSpec(Strict):
    """A point of a person's path."""

    at_m: Point
    speed_m_s: Annotated[float, Field(ge=0.1, le=2.5)] = 1.2
    """walking speed on the way there"""
    pause_s: Seconds = 0.0
    """how long the person stays there"""
    face: Face | None = None
    """where the person looks meanwhile: robot, another person's name, or a point"""
    posture: Literal["standing", "sitting", "bending", "arms_raised", "arms_crossed"] = "standing"
    """posture during the pause"""


class _Walk(Strict):
    """What single people and groups have in common."""

    path: Annotated[tuple[WaypointSpec, ...], Field(strict=False, min_length=1, max_length=500)]
    enter_s: Seconds = 0.0
    """when they appear, at the first point"""
    leave_s: Seconds | None = None
    """when they vanish; left out, they stay at the last point"""
    yields: bool = False
    """whether they make way for the robot and for each other"""
    jitter_m: Annotated[float, Field(ge=0.0, le=2.0)] = 0.0
    """radius within which the seed moves each point"""
    speed_jitter: Annotated[float, Field(ge=0.0, le=0.5)] = 0.0
    """share by which the seed changes all speeds, up or down"""
    enter_jitter_s: Annotated[float, Field(ge=0.0, le=60.0)] = 0.0
    """the seed delays the entry by up to this long"""


class PersonSpec(_Walk):
    """A walking person; looks that are left out are drawn from the seed."""

    name: Name
    height_m: Annotated[float, Field(ge=1.5, le=2.0)] | None = None
    sex: Literal["female", "male"] | None = None
    build: Literal["slim", "average", "stout"] | None = None
    clothes: ClothesSpec | None = None
    bag: bool = False
    arms: Literal["swinging", "crossed", "raised"] = "swinging"
    """what the arms do while walking"""


class GroupSpec(_Walk):
    """People who walk abreast along one path, from its right side to its left."""

    names: Annotated[tuple[Name, ...], Field(strict=False, min_length=2, max_length=6)]
    spacing_m: Annotated[float, Field(ge=0.5, le=3.0)] = 0.75


class LightSpec(Strict):
    """From a time on, the room's light has a level."""

    at_s: Seconds
    level: Annotated[float, Field(ge=0.0, le=2.0)]
    """0 is dark, 1 is full light"""


class CameraSpec(Strict):
    """What differs from the robot's usual camera."""

    width_px: Annotated[int, Field(ge=16, le=4096)] | None = None
    height_px: Annotated[int, Field(ge=16, le=4096)] | None = None
    vertical_fov_deg: Annotated[float, Field(ge=5.0, le=150.0)] | None = None
    mount_m: Annotated[tuple[Coordinate, Coordinate, Coordinate], Field(strict=False)] | None = None
    """optical centre in the robot's frame: forward, left, up from the floor"""
    pitch_deg: Annotated[float, Field(ge=-90.0, le=90.0)] | None = None
    yaw_deg: Annotated[float, Field(ge=-180.0, le=180.0)] | None = None
    exposure_s: Annotated[float, Field(ge=0.0, le=1.0)] | None = None


class ThermalSpec(CameraSpec):
    """What differs from the usual thermal camera."""

    blur_px: Annotated[float, Field(ge=0.0, le=20.0)] | None = None
    netd_k: Annotated[float, Field(ge=0.0, le=5.0)] | None = None
    fixed_pattern_k: Annotated[float, Field(ge=0.0, le=5.0)] | None = None
    dead_pixels: Share | None = None


class CommandSpec(Strict):
    """From a time on, a scripted robot drives at this velocity."""

    from_s: Seconds
    linear_m_s: Annotated[float, Field(ge=-2.0, le=2.0)] = 0.0
    angular_deg_s: Annotated[float, Field(ge=-360.0, le=360.0)] = 0.0


class RobotSpec(Strict):
    """The robot: where it starts and what it does."""

    at_m: Point
    heading_deg: Degrees = 0.0
    behaviour: Literal["stand", "follow_person", "follow_corridor", "patrol", "scripted"] = "stand"
    commands: Annotated[tuple[CommandSpec, ...], Field(strict=False)] = ()
    """of a scripted robot, in the order of time"""
    keep_height: Annotated[float, Field(gt=0.05, le=1.5)] | None = None
    """of a following robot: the person's height in the image, in image heights, at which it stops"""
    walls_by: Literal["sonar", "image"] | None = None
    """of a robot that follows corridors: the sense that tells it the walls; left out, the sonar"""
    thermal: ThermalSpec = ThermalSpec()
    colour: CameraSpec = CameraSpec()


class FaultSpec(Strict):
    """Something that breaks for a while."""

    kind: Literal["camera_frozen", "camera_black", "tracker_raises", "sonar_maximum", "odometry_jumps"]
    """the cameras give the last images again and again, or black ones; the tracker fails at every image; all
    sonars say that there is nothing; the odometry's pose jumps at once and again every second"""
    from_s: Seconds
    lasts_s: Seconds | None = None
    """left out, it lasts to the end"""


class DrawnSpec(Strict):
    """In a run's folder: what everything was drawn from."""

    seed: Annotated[int, Field(ge=0)]
    versions: dict[str, str] = {}
    drive: Literal["drive.parquet"] | None = None
    """commands that the robot repeats, in a file beside this one, whatever its behaviour is"""


class ScenarioSpec(Strict):
    """A scenario file."""

    name: Key
    description: Annotated[str, Field(min_length=1, max_length=1000)]
    like: Key | None = None
    """a scenario of the library, whose keys stand in for those that this file leaves out"""
    duration_s: Annotated[float, Field(gt=0.0, le=36000.0)]
    place: PlaceSpec
    things: Annotated[tuple[ThingSpec, ...], Field(strict=False, max_length=300)] = ()
    people: Annotated[tuple[PersonSpec, ...], Field(strict=False, max_length=60)] = ()
    groups: Annotated[tuple[GroupSpec, ...], Field(strict=False, max_length=20)] = ()
    clothes_differ: bool = False
    """whether the seed draws clearly different colours for those whose colours the file leaves out"""
    lights: Annotated[tuple[LightSpec, ...], Field(strict=False)] = ()
    """steps of the room's light, in the order of time; left out, it is full light"""
    robot: RobotSpec
    faults: Annotated[tuple[FaultSpec, ...], Field(strict=False, max_length=50)] = ()
    """what breaks, to try a controller"""
    drawn: DrawnSpec | None = None


def json_schema() -> dict[str, Any]:
    """The JSON schema of scenario files, for editors; a file that is like another may leave keys out."""
    schema = ScenarioSpec.model_json_schema()
    required = schema.pop("required")
    return schema | {"anyOf": [{"required": required}, {"required": ["name", "description", "like"]}]}
