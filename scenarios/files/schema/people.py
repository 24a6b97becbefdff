"""People: how they look and where they walk, alone or abreast."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from peopleboy.scenarios.files.schema.reactions import LeadSpec, ReactionSpec
from peopleboy.scenarios.files.schema.values import Colour, Face, Name, Point, Seconds, Strict
from peopleboy.sim.people.body.clothes import BOTTOMS, HAIR, SHOES, TOPS
from peopleboy.sim.people.reaction import FROM_M


class ClothesSpec(Strict):
    """What a person wears; what is left out is drawn from the seed."""

    top: Literal[*TOPS] | None = Field(  # type: ignore[valid-type]
        default=None, description="shirt, jumper or the like"
    )
    bottom: Literal[*BOTTOMS] | None = Field(  # type: ignore[valid-type]
        default=None, description="trousers, skirt or the like"
    )
    shoes: Literal[*SHOES] | None = Field(default=None, description="shoes")  # type: ignore[valid-type]
    hair: Literal[*HAIR] | None = Field(  # type: ignore[valid-type]
        default=None, description="hair, or a cap on it"
    )
    top_colour: Colour | None = Field(default=None, description="of the top")
    bottom_colour: Colour | None = Field(default=None, description="of the bottom")
    hair_colour: Colour | None = Field(default=None, description="of the hair")


class WaypointSpec(Strict):
    """A point of a person's path."""

    at_m: Point = Field(description="where it is")
    speed_m_s: float = Field(default=1.2, ge=0.1, le=2.5, description="walking speed on the way there")
    pause_s: Seconds = Field(default=0.0, description="how long the person stays there")
    face: Face | None = Field(
        default=None, description="where the person looks meanwhile: robot, another person's name, or a point"
    )
    until_robot_within_m: float | None = Field(
        default=None,
        ge=FROM_M[0],
        le=FROM_M[1],
        description="the pause lasts until the robot is so near, too, to which the person turns if `face` "
        "says nothing else; left out, it does not wait for the robot",
    )
    waits_at_most_s: float = Field(
        default=60.0, gt=0.0, le=3600.0, description="for the robot, after `pause_s`"
    )
    posture: Literal["standing", "sitting", "bending", "arms_raised", "arms_crossed", "calling"] = Field(
        default="standing",
        description="posture during the pause: `standing` upright, arms at the sides; `sitting` as on a "
        "chair, which may stand at that point; `bending` forward; `arms_raised`, both of them; "
        "`arms_crossed` in front of the chest; `calling` with one arm raised, which waves, until the robot "
        "is as near as `until_robot_within_m` says",
    )


class _Walk(Strict):
    """What single people and groups have in common."""

    path: tuple[WaypointSpec, ...] = Field(
        strict=False,
        min_length=1,
        max_length=500,
        description="the points that they walk to, one after the other",
    )
    enter_s: Seconds = Field(default=0.0, description="when they appear, at the first point")
    leave_s: Seconds | None = Field(
        default=None, description="when they vanish; left out, they stay at the last point"
    )
    yields: bool = Field(default=False, description="whether they make way for the robot and for each other")
    jitter_m: float = Field(
        default=0.0, ge=0.0, le=2.0, description="radius within which the seed moves each point"
    )
    speed_jitter: float = Field(
        default=0.0, ge=0.0, le=0.5, description="share by which the seed changes all speeds, up or down"
    )
    enter_jitter_s: float = Field(
        default=0.0, ge=0.0, le=60.0, description="the seed delays the entry by up to this long"
    )
    group: Name | None = Field(
        default=None,
        description="word for those who keep together: who is ahead slows for who is behind, and waits; all "
        "of one word have paths of as many points",
    )
    reacts: ReactionSpec | None = Field(
        default=None,
        description="how they take to the robot; left out, they take no note of it in particular",
    )


class PersonSpec(_Walk):
    """A walking person; looks that are left out are drawn from the seed."""

    name: Name = Field(description="unlike all other names in the scenario")
    height_m: float | None = Field(
        default=None, ge=1.5, le=2.0, description="from the floor to the top of the head"
    )
    sex: Literal["female", "male"] | None = Field(
        default=None, description="decides proportions and usual height"
    )
    build: Literal["slim", "average", "stout"] | None = Field(
        default=None, description="how wide the body is for its height"
    )
    clothes: ClothesSpec | None = Field(default=None, description="what the person wears")
    bag: bool = Field(default=False, description="whether the person carries a bag")
    arms: Literal["swinging", "crossed", "raised"] = Field(
        default="swinging", description="what the arms do while walking"
    )
    leads: LeadSpec | None = Field(
        default=None, description="how the person leads the robot along its path; left out, it does not"
    )


class GroupSpec(_Walk):
    """People who walk abreast along one path, from its right side to its left."""

    path: tuple[WaypointSpec, ...] = Field(
        strict=False,
        min_length=2,
        max_length=500,
        description="the points that they walk to; the way between them tells which side is right",
    )
    names: tuple[Name, ...] = Field(
        strict=False,
        min_length=2,
        max_length=6,
        description="one for each person, from the right side to the left",
    )
    spacing_m: float = Field(default=0.75, ge=0.5, le=3.0, description="distance between neighbours")
