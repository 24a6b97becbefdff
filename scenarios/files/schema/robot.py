"""The robot: its cameras, what it does, and what breaks."""

from __future__ import annotations

from typing import Annotated, Any, Literal, get_args

from pydantic import (
    Discriminator,
    Field,
    SerializeAsAny,
    Tag,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    model_validator,
)

from peopleboy.scenarios.files.schema.values import (
    CameraName,
    Degrees,
    Point,
    Position,
    Seconds,
    Share,
    Strict,
)
from peopleboy.sim.cameras.kinds import KINDS
from peopleboy.sim.cameras.presets import DEPTH_PRESETS, THERMAL_PRESETS

Failure = Literal["camera_frozen", "camera_black", "tracker_raises", "sonar_maximum", "odometry_jumps"]


ORACLE = "truth"
"""Name of the eyes that are told who is where."""


class _AnyCamera(Strict):
    """What all cameras have; what is left out is as usual for the kind."""

    width_px: int | None = Field(
        default=None,
        ge=16,
        le=4096,
        description="columns of the image; usually 320, of a panorama 480, of depth 640",
    )
    height_px: int | None = Field(
        default=None,
        ge=16,
        le=4096,
        description="rows of the image; usually 240, of a panorama 120, of depth 480",
    )
    exposure_s: float | None = Field(
        default=None, ge=0.0, le=1.0, description="time over which rotation blurs the image"
    )
    rate_hz: int | None = Field(
        default=None,
        ge=1,
        le=15,
        description="images a second: 1, 3, 5 or 15; usually 15, as `thermal` and `colour` always have",
    )


class _Camera(_AnyCamera):
    """What all cameras have whose image is flat."""

    vertical_fov_deg: float | None = Field(
        default=None,
        ge=5.0,
        le=150.0,
        description="angle from upper to lower edge; usually 44, of a colour camera 37.2, of depth 43",
    )
    mount_m: Position | None = Field(
        default=None, description="optical centre in the robot's frame: forward, left, up from the floor"
    )
    pitch_deg: float | None = Field(default=None, ge=-90.0, le=90.0, description="tilt; positive looks down")
    yaw_deg: float | None = Field(default=None, ge=-180.0, le=180.0, description="pan; positive looks left")


class ThermalCameraSpec(_Camera):
    """A camera that sees heat; by the name `thermal` it is the one that the tracker looks through."""

    kind: Literal["thermal"] = Field(
        description="what it sees: heat, in 8 bits and in hundredths of a kelvin"
    )
    preset: Literal[*THERMAL_PRESETS] | None = Field(  # type: ignore[valid-type]
        default=None,
        description="what stands in for the keys that are left out: `uncooled`, with a plateau gain, "
        "sharpened edges, columns, warm corners, drift and a shutter; `uncooled_film`, that by way of JPEG",
    )
    gain: Literal["fixed", "percentile", "plateau"] | None = Field(
        default=None,
        description="how 8-bit grey comes from temperature: `fixed`, the usual one, linear over `lowest_c` "
        "to `highest_c`; `percentile`, linear over the span of the image; `plateau`, its histogram equalised "
        "as far as a plateau allows",
    )
    lowest_c: float | None = Field(
        default=None, ge=-40.0, le=160.0, description="of gain `fixed`: what is black; usually 24"
    )
    highest_c: float | None = Field(
        default=None, ge=-40.0, le=160.0, description="of gain `fixed`: what is white; usually 36"
    )
    gain_follows_s: float | None = Field(
        default=None,
        ge=0.0,
        le=60.0,
        description="time constant with which an automatic gain follows the images; usually 1; 0 for at once",
    )
    tail_percent: float | None = Field(
        default=None,
        ge=0.0,
        le=0.45,
        description="of the pixels, what may lie outside an automatic gain's span at either end; usually 0.3",
    )
    least_span_k: float | None = Field(
        default=None,
        ge=0.5,
        le=200.0,
        description="what an automatic gain spreads over all greys at least; usually 5",
    )
    plateau_percent: float | None = Field(
        default=None,
        ge=0.01,
        le=100.0,
        description="of gain `plateau`: share of the pixels that 0.05 K count for at most; usually 0.5; 100 "
        "equalises fully",
    )
    linear_share: Share | None = Field(
        default=None,
        description="of gain `plateau`: share of the greys that are linear over its span; usually 0.3",
    )
    blur_px: float | None = Field(
        default=None, ge=0.0, le=20.0, description="blur of the optics, a standard deviation"
    )
    netd_k: float | None = Field(
        default=None, ge=0.0, le=5.0, description="noise that is new in every image, a standard deviation"
    )
    fixed_pattern_k: float | None = Field(
        default=None, ge=0.0, le=5.0, description="offsets between pixels that stay, a standard deviation"
    )
    dead_pixels: Share | None = Field(
        default=None, description="share of the pixels that read one value all the time"
    )
    column_noise_k: float | None = Field(
        default=None,
        ge=0.0,
        le=5.0,
        description="offsets between columns that stay until the next calibration, a standard deviation; "
        "usually 0",
    )
    vignetting_k: float | None = Field(
        default=None, ge=0.0, le=10.0, description="how much warmer corners seem than the middle; usually 0"
    )
    offset_drift_k_per_min: float | None = Field(
        default=None,
        ge=0.0,
        le=20.0,
        description="how fast all of the image drifts away after a calibration, a standard deviation; its "
        "patches by half of that, its pixels by a tenth; usually 0",
    )
    shutter_every_s: float | None = Field(
        default=None,
        ge=0.0,
        le=3600.0,
        description="time from one calibration, before a shutter, to the next; usually 0, for none",
    )
    shutter_lasts_s: float | None = Field(
        default=None, ge=0.0, le=5.0, description="for how long the image stands still then; usually 0.4"
    )
    sharpening: float | None = Field(
        default=None,
        ge=0.0,
        le=5.0,
        description="how much of what blur would take away is added in 8 bits; halos come with it; usually 0",
    )
    sharpening_px: float | None = Field(
        default=None, gt=0.0, le=20.0, description="of that blur, a standard deviation; usually 1.5"
    )
    coring_k: float | None = Field(
        default=None,
        ge=0.0,
        le=5.0,
        description="details of 8 bits that differ by less from what is about them are taken for noise and "
        "evened out; usually 0",
    )
    jpeg_quality: int | None = Field(
        default=None,
        ge=1,
        le=100,
        description="of the compression that the 8-bit image went through; usually none",
    )


class ColourCameraSpec(_Camera):
    """A camera that sees colours; by the name `colour` it is the one that the tracker looks through."""

    kind: Literal["colour"] = Field(description="what it sees: light")


class MirrorSpec(Strict):
    """The mirror of a panoramic camera, a cone over a lens that looks up; what is left out is as usual."""

    half_apex_deg: float | None = Field(
        default=None, gt=45.0, le=89.0, description="between the cone's axis and its side; usually 72.5"
    )
    lens_half_angle_deg: float | None = Field(
        default=None, gt=0.0, le=85.0, description="between the lens's axis and the image's rim; usually 47"
    )
    lens_m: float | None = Field(
        default=None, gt=0.0, le=1.0, description="from the lens up to the cone's tip; usually 0.04"
    )
    apex_m: float | None = Field(
        default=None, gt=0.0, le=10.0, description="height of the cone's tip above the floor; usually 1.68"
    )


def _word_or_values(value: Any) -> str:
    return "word" if isinstance(value, str) else "values"


_Mirror = Annotated[
    Annotated[Literal["default", "narrow"], Tag("word")] | Annotated[MirrorSpec, Tag("values")],
    Discriminator(_word_or_values),
]


class PanoramaCameraSpec(_AnyCamera):
    """A colour camera that sees all round, by a mirror over the robot's axis; its image is unrolled."""

    kind: Literal["panorama"] = Field(description="what it sees: light, all round")
    mirror: _Mirror | None = Field(
        default=None,
        description="`default` sees from 8 to 55 degrees below the horizon, `narrow` from 8 to 35; or the "
        "values of another",
    )
    raw: bool | None = Field(
        default=None,
        description="whether the image is unrolled from the round one that the lens sees, and that one is "
        "kept, too; usually false",
    )


class DepthCameraSpec(_Camera):
    """A camera that measures depth, and sees colours by the same lens."""

    kind: Literal["depth"] = Field(description="what it sees: how far everything is, and light")
    preset: Literal[*DEPTH_PRESETS] | None = Field(  # type: ignore[valid-type]
        default=None,
        description="what stands in for the keys that are left out: `tof`, 176x144 by time of flight, "
        "pitched down by 12 degrees, with amplitude instead of colour; `kinect`, 320x240; `kinect_rough`, "
        "that with four times the noise",
    )
    sensor: Literal["kinect", "tof"] | None = Field(
        default=None,
        description="how it measures: `kinect`, the usual one, by a pattern of light, with noise and steps "
        "in disparity, shadows, frayed edges and holes; `tof` by the time that light takes, with depths "
        "between two surfaces at edges",
    )
    scale: float | None = Field(
        default=None,
        ge=0.0,
        le=100.0,
        description="of the noise of its depth; usually 1; 0 gives exact depth, without holes but beyond its "
        "range",
    )
    nearest_m: float | None = Field(
        default=None, ge=0.0, le=65.0, description="depth from which on it measures; usually 0.5"
    )
    farthest_m: float | None = Field(
        default=None, gt=0.0, le=65.0, description="depth up to which it measures; usually 10"
    )
    colour: bool | None = Field(
        default=None,
        description="whether it gives colour, pixel for pixel beside the depth; usually true",
    )
    amplitude: bool | None = Field(
        default=None,
        description="of sensor `tof`: whether it gives the strength of its light that comes back, too; "
        "usually false",
    )
    offset_m: float | None = Field(
        default=None,
        ge=0.0,
        le=0.1,
        description="largest error of a pixel that is the same in all images; usually 0",
    )


class PlainCameraSpec(_Camera):
    """A camera of any further kind: it has the keys that all have, and none of its own."""

    kind: str


_OwnCameraSpec = ThermalCameraSpec | ColourCameraSpec | PanoramaCameraSpec | DepthCameraSpec
CameraSpec = _OwnCameraSpec | PlainCameraSpec
_WITH_OWN_KEYS = frozenset(
    get_args(spec.model_fields["kind"].annotation)[0] for spec in get_args(_OwnCameraSpec)
)


def _by_kind(data: Any, with_own_keys: ValidatorFunctionWrapHandler) -> Any:
    """Read a camera of a kind that says nothing of its own keys; its kind may be younger than this schema."""
    kind = data.get("kind") if isinstance(data, dict) else None
    is_plain = isinstance(kind, str) and kind in KINDS and kind not in _WITH_OWN_KEYS
    return PlainCameraSpec.model_validate(data) if is_plain else with_own_keys(data)


_ByKind = Annotated[_OwnCameraSpec, Field(discriminator="kind")]


class CommandSpec(Strict):
    """From a time on, a scripted robot drives at this velocity, or as near to it as its drive comes.

    The drive does at most 0.8 m/s and 150 deg/s, and comes to them at 0.6 m/s2 and 200 deg/s2. The guard,
    which keeps 0.45 m to what the sonars see, stops it before walls and people as it does any robot.
    """

    from_s: Seconds = Field(description="when the robot begins to drive so")
    linear_m_s: float = Field(default=0.0, ge=-2.0, le=2.0, description="forward speed; negative drives back")
    angular_deg_s: float = Field(
        default=0.0, ge=-360.0, le=360.0, description="turn rate; positive turns left"
    )


class RobotSpec(Strict):
    """The robot: where it starts and what it does."""

    at_m: Point = Field(description="where it starts")
    heading_deg: Degrees = Field(default=0.0, description="where it looks at the start")
    behaviour: Literal["stand", "follow_person", "follow_corridor", "patrol", "scripted"] = Field(
        default="stand",
        description="what drives it: `stand`, nothing does; `follow_person` finds a person and follows, up "
        "to where that one looks as tall as `keep_height` says; `follow_corridor` keeps to the middle of a "
        "corridor, turns at its end, and waits for people in the way; `patrol` follows a corridor until "
        "somebody turns up, follows that person for a while, and returns; `scripted` drives as `commands` "
        "says",
    )
    commands: tuple[CommandSpec, ...] = Field(
        default=(), strict=False, description="of a scripted robot, in the order of time"
    )
    keep_height: float | None = Field(
        default=None,
        gt=0.05,
        le=1.5,
        description="of a following robot: the person's height in the image [image heights] where it stops",
    )
    walls_by: Literal["sonar", "image"] | None = Field(
        default=None,
        description="of a robot in corridors: the sense that tells it the walls; left out, the sonar",
    )
    tracker: str | None = Field(
        default=None,
        pattern="^[a-z][a-z0-9_-]*$",
        description="whose eyes the robot sees people with, by a name that `--tracker` takes, and which that "
        "option overrules; left out, `detection`",
    )
    cameras: dict[CameraName, SerializeAsAny[Annotated[_ByKind, WrapValidator(_by_kind)]]] = Field(
        default={},
        description="by name; `thermal` and `colour` are there anyway, and what is said of them is what "
        "differs from the usual; any other name is a further camera",
    )

    @model_validator(mode="before")
    @classmethod
    def _say_where_cameras_are(cls, data: Any) -> Any:
        """Help whoever knows where cameras used to be."""
        for name in ("thermal", "colour"):
            if isinstance(data, dict) and name in data:
                raise ValueError(f"{name!r} is a camera: write cameras: {{{name}: {{kind: {name}, ...}}}}")
        return data


class FaultSpec(Strict):
    """Something that breaks for a while."""

    kind: Failure = Field(
        description="`camera_frozen`: the cameras give the last images again and again; `camera_black`: they "
        "give black ones; `tracker_raises`: the tracker fails at every image; `sonar_maximum`: all sonars "
        "say that there is nothing; `odometry_jumps`: the odometry's pose jumps at once, and again every "
        "second"
    )
    from_s: Seconds = Field(description="when it begins")
    lasts_s: Seconds | None = Field(default=None, description="left out, it lasts to the end")
