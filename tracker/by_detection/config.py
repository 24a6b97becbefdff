"""Settings of the tracker by detection. Lengths are metres, times seconds, scores log odds."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Final

STATURE_M: Final = 1.72
"""How tall everybody is taken to be: what a height in the image says of the distance."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PathConfig:
    """How people move, and how well a box tells where they are.

    Attributes:
        acceleration_m_s2: deviation of the acceleration to the right, down, and away.
        speed_m_s: deviation of the velocity of somebody just found, along the same.
        column: deviation of a box's middle column, in its heights.
        head: deviation of its upper end, in its heights.
        foot: deviation of its lower end, likewise.
        build: deviation of the logarithm of people's stature.
        posture: by how much that changes in a second, as people sit down or bend.
        floor_m: deviation of feet from the floor, where it is known.
        shown: share of the box of this image in the one that is told; the rest is where the path leads.
    """

    acceleration_m_s2: tuple[float, float, float] = (0.6, 0.2, 0.6)
    speed_m_s: tuple[float, float, float] = (1.0, 0.2, 1.0)
    column: float = 0.05
    head: float = 0.07
    foot: float = 0.07
    build: float = 0.04
    posture: float = 0.02
    floor_m: float = 0.08
    shown: float = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class GazeConfig:
    """Where an image is looked at, and how closely.

    Attributes:
        unsettled_s: as long as it is open who is there, images that come so soon after one that was searched
            everywhere are looked at where people are expected who were seen just before, and nowhere else: of
            15 images a second two of three.
        settled_s: the same while whoever is known is a person, and was just seen: five of six.
        breadth: tangent of half the angle from side to side of a camera for which that is so; a narrower one,
            which is crossed sooner by whoever walks past, is searched the more often.
        lost_s: for how long it is open where somebody is who was not found.
        look_s: of who stands apart, images that come so soon after the detector's networks looked there are
            only compared with a portrait of then.
        alike: least correlation with it.
        anew_s: searches that come so soon after trees found somebody who stands apart pass him by, if his
            portrait shows where he is: the networks look there.
    """

    unsettled_s: float = 0.14
    settled_s: float = 0.34
    breadth: float = 0.53
    lost_s: float = 1.0
    look_s: float = 0.19
    alike: float = 0.8
    anew_s: float = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class MatchingConfig:
    """What it costs to take a proposal for a person.

    Attributes:
        gate: Mahalanobis distance of proposals that are nobody's own.
        path: cost of a unit of it.
        overlap: cost of boxes that do not overlap at all.
        looks: cost of looks that are the opposite.
        score: what a unit of the proposal's score takes off.
        highest: cost that is too high.
        lost_s: who was not seen for longer comes after all others.
        looks_of_lost: least likeness of who was lost, -1 to 1, where colours are not known.
        colours_of_same: likeness of colours from which on somebody may be one who was lost, however far from
            where he is expected.
    """

    gate: float = 3.5
    path: float = 0.35
    overlap: float = 1.5
    looks: float = 1.3
    score: float = 0.05
    highest: float = 2.6
    lost_s: float = 1.0
    looks_of_lost: float = 0.35
    colours_of_same: float = 0.3


@dataclass(frozen=True, slots=True, kw_only=True)
class RecognitionConfig:
    """When people turn out to be others than they were taken for.

    Attributes:
        gone_s: who was not found for so long may be somebody new.
        revised_s: for how long after somebody new is told he may still turn out to be another one.
        parted_s: how long people who met are seen apart before it is decided who is who.
        margin: by how much better they must look like each other, in sums of Bhattacharyya's coefficient.
        same: coefficient from which on somebody new is one of those who were lost.
    """

    gone_s: float = 0.2
    revised_s: float = 3.0
    parted_s: float = 0.5
    margin: float = 0.2
    same: float = 0.8


@dataclass(frozen=True, slots=True, kw_only=True)
class ExistenceConfig:
    """When somebody is believed to be there, by the log odds that add up.

    Attributes:
        weakest: proposals of a lower score are not looked at.
        trust: what a unit of the others counts: of cameras unlike those that taught it the detector is too
            sure.
        lasting: what is added to them: who is hardly somebody, in one image after another, is nobody more
            often than single images say.
        birth: score of a proposal that may be somebody new.
        independent_s: images so far apart speak for themselves, at the soonest.
        still_s: the same of who stands still: what looks like somebody does so in the next image, too.
        look_m: who has gone so far is looked at anew.
        as_seen_now: what counts at once of how much surer an image is than all before: who was hardly seen
            in the first ones, as behind a door, does not look the same in the next.
        highest_score: what one image can say at most.
        shared_doubt: what is taken off the score of somebody new whose box is all within that of another,
            from the second image on.
        highest: what all can say.
        sightings: images in which somebody must have been found to be told.
        at_once: score of a single image that is enough.
        confirmed: log odds at which somebody is told.
        hopeless: log odds below which nobody is followed.
        missed: what an image without somebody says who should be seen.
        missed_hidden: the same of somebody behind others.
        doubt_s: who was not found for so long is told no more.
        hidden_doubt_s: the same of somebody behind others.
        hidden_share: the same, as a share of how long he was watched: a mistake that is made beside somebody
            seems to be hidden by him in the end.
        forget_s: who was not found for so long is forgotten.
        brief_s: of who was seen for less than that, `brief_forget_s`.
        brief_forget_s: who was hardly seen is forgotten sooner.
    """

    weakest: float = -2.0
    trust: float = 0.8
    lasting: float = -0.2
    birth: float = -0.5
    independent_s: float = 0.25
    still_s: float = 4.0
    look_m: float = 0.25
    as_seen_now: float = 0.4
    highest_score: float = 3.0
    shared_doubt: float = 2.0
    highest: float = 8.0
    sightings: int = 2
    at_once: float = 3.0
    confirmed: float = 2.0
    hopeless: float = -0.5
    missed: float = 1.0
    missed_hidden: float = 0.3
    doubt_s: float = 0.25
    hidden_doubt_s: float = 1.0
    hidden_share: float = 0.5
    forget_s: float = 10.0
    brief_s: float = 1.0
    brief_forget_s: float = 2.0


@dataclass(frozen=True, slots=True, kw_only=True)
class BothCamerasConfig:
    """What the detector, which was taught by thermal images, says of the brightness of colour images.

    Attributes:
        every_s: how often it looks there, at the most.
        beside_s: the same while the thermal image shows somebody.
        alone_every_s: the same while colours show somebody whom the thermal image does not.
        believed: share of its log odds that is believed.
        same: IoU from which on what both cameras show is one person.
        shared: of the smaller box: up to there whom colours alone show is another one.
        alone: least score of whom colours alone show.
    """

    every_s: float = 0.79
    beside_s: float = 1.59
    alone_every_s: float = 0.19
    believed: float = 0.85
    same: float = 0.45
    shared: float = 0.65
    alone: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ByDetectionConfig:
    """All settings of the tracker by detection.

    Attributes:
        path: how people move.
        gaze: where images are looked at.
        matching: what it costs to take a proposal for a person.
        existence: when somebody is believed to be there.
        identity: when people turn out to be others.
        gaze_uncalibrated: where images are looked at where nothing is known of the camera: everywhere.
        existence_uncalibrated: when somebody is, where nothing is known of the camera: neither does the
            detector know images like its, nor is anybody known to stand on the floor.
        matching_uncalibrated: what it costs to take a proposal for a person there, where no colours tell
            people apart in crowds.
        identity_uncalibrated: when people turn out to be others there: boxes fit a colour image less well.
        colour: what is believed of the colour image.
    """

    path: PathConfig = field(default_factory=PathConfig)
    gaze: GazeConfig = field(default_factory=GazeConfig)
    matching: MatchingConfig = field(default_factory=MatchingConfig)
    existence: ExistenceConfig = field(default_factory=ExistenceConfig)
    identity: RecognitionConfig = field(default_factory=RecognitionConfig)
    gaze_uncalibrated: GazeConfig = field(
        default_factory=lambda: GazeConfig(unsettled_s=0.0, settled_s=0.0, anew_s=0.0)
    )
    existence_uncalibrated: ExistenceConfig = field(
        default_factory=lambda: ExistenceConfig(
            birth=0.5,
            sightings=4,
            at_once=math.inf,
            confirmed=2.3,
            shared_doubt=4.0,
            hidden_doubt_s=0.5,
            hidden_share=math.inf,
        )
    )
    matching_uncalibrated: MatchingConfig = field(
        default_factory=lambda: MatchingConfig(highest=2.3, lost_s=4.0)
    )
    identity_uncalibrated: RecognitionConfig = field(default_factory=lambda: RecognitionConfig(same=0.65))
    colour: BothCamerasConfig = field(default_factory=BothCamerasConfig)
