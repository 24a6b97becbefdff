"""Settings of the people tracker. Lengths are metres, times seconds, scores log-odds."""

import math
from dataclasses import dataclass, field, replace
from typing import Final

NEAREST_M: Final = 0.3
"""Least distance of a person ahead of a camera."""

STATURE_M: Final = 1.72
"""Assumed stature of a person, from which the height of a box gives the distance."""

USUAL_RATIO: Final = 0.2
"""Width of a person's box, in heights, where it is not measured."""


@dataclass(frozen=True, slots=True, kw_only=True)
class KalmanConfig:
    """Motion and measurement noise of the Kalman filter.

    Attributes:
        acceleration_m_s2: standard deviation of the acceleration to the right, down and away.
        speed_m_s: standard deviation of the velocity of a new track, along the same axes.
        column: standard deviation of a box's middle column, in box heights.
        head: standard deviation of its upper end, in box heights.
        foot: standard deviation of its lower end, in box heights.
        build: standard deviation of the log stature.
        posture: change of the log stature in a second, as people sit down or bend.
        floor_m: standard deviation of the feet from the floor, where the floor is known.
        toe_m: how much nearer than the middle of a person the lower end of the box is: the front foot.
        nearest_m: least distance ahead of the robot, for sensors that see nothing behind it.
        shown: weight of the detected box in the output box; the rest is the prediction.
    """

    acceleration_m_s2: tuple[float, float, float] = (0.6, 0.2, 0.6)
    speed_m_s: tuple[float, float, float] = (1.0, 0.2, 1.0)
    column: float = 0.05
    head: float = 0.07
    foot: float = 0.07
    build: float = 0.04
    posture: float = 0.02
    floor_m: float = 0.08
    shown: float = 0.8
    toe_m: float = 0.12
    nearest_m: float = NEAREST_M


@dataclass(frozen=True, slots=True, kw_only=True)
class DetectionScheduleConfig:
    """When the detector searches a whole image, rescores predicted boxes, or relies on templates.

    Attributes:
        unsettled_s: least time between two searches of a whole image in an unsettled scene. In between, only
            predicted boxes of tracks seen just before are rescored: two of three images at 15 Hz.
        settled_s: the same while every track is confirmed and was just seen: five of six images.
        breadth: tangent of half the horizontal field of view for which `settled_s` holds; a narrower camera,
            which people cross sooner, is searched more often in proportion.
        lost_s: how long a track that was missed keeps the scene unsettled.
        rescore_s: an isolated track that was rescored more recently is followed by its template only.
        min_correlation: least correlation of the template.
        anew_s: a search passes over an isolated track that the cascade found more recently, if its template
            matches: the networks rescore it there.
    """

    unsettled_s: float = 0.14
    settled_s: float = 0.34
    breadth: float = 0.53
    lost_s: float = 1.0
    rescore_s: float = 0.19
    min_correlation: float = 0.8
    anew_s: float = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class AssociationConfig:
    """Cost of assigning a detection to a track.

    Attributes:
        gate: greatest Mahalanobis distance.
        motion: cost of a unit of Mahalanobis distance.
        overlap: cost of boxes that do not overlap.
        appearance: cost of opposite appearance.
        score: discount for a unit of the detection's score.
        highest: greatest cost of an assignment.
        lost_s: tracks unseen for longer are assigned after all others.
        pattern_of_lost: least similarity of the thermal pattern, -1 to 1, of a lost track of unknown colours.
        colours_of_same: least similarity of colours for a lost track, however far from its prediction.
    """

    gate: float = 3.5
    motion: float = 0.35
    overlap: float = 1.5
    appearance: float = 1.3
    score: float = 0.05
    highest: float = 2.6
    lost_s: float = 1.0
    pattern_of_lost: float = 0.35
    colours_of_same: float = 0.3


@dataclass(frozen=True, slots=True, kw_only=True)
class ReidentificationConfig:
    """When tracks are recognised again, and when exchanged identities are resolved.

    Attributes:
        lost_s: a track unseen for so long may be a new one's earlier self.
        revised_s: how long after its confirmation a new track may still be reidentified.
        parted_s: how long people who met must be seen apart before swapped identities are resolved.
        margin: gain in summed Bhattacharyya coefficients that a swap needs.
        same: Bhattacharyya coefficient from which a track resembles another one's earlier self.
        colour_gain: log-odds for a unit of the coefficient.
        colour_neutral: coefficient at log-odds 0.
        colour_most: greatest log-odds of colours.
        known_gain, known_neutral: the first two for people of earlier runs.
        colour_unknown: log-odds where colours are unknown.
        uses_place: whether motion and stature count; else colours alone do, by `same`.
        walk_m, walk_m_s: standard deviation of how far a lost person is from where they were last seen, and
            its growth.
        stray_m_s: the same growth of how far they are from where they would be if they had walked on.
        room_m2: area in which another person may be found.
        least_near: least log-odds of motion.
        statures: standard deviation of the log statures of people.
        stature_error: error of an estimate beyond its own.
        least: log-odds from which a new track is a lost one.
        provisional_s: how long after that the track may still turn out to be of another person,
        same_again: by a coefficient of clear appearances below this.
        unclear: how much less than these leave the identity of a new track open,
        undecided_s: for at most so long.
    """

    lost_s: float = 0.2
    revised_s: float = 3.0
    parted_s: float = 0.5
    margin: float = 0.2
    same: float = 0.8
    colour_gain: float = 16.0
    colour_neutral: float = 0.8
    colour_most: float = 2.0
    known_gain: float = 30.0
    known_neutral: float = 0.9
    colour_unknown: float = 0.0
    uses_place: bool = True
    walk_m: float = 0.4
    walk_m_s: float = 0.5
    stray_m_s: float = 0.3
    room_m2: float = 40.0
    least_near: float = -4.0
    statures: float = 0.05
    stature_error: float = 0.03
    least: float = 0.0
    provisional_s: float = 6.0
    same_again: float = 0.7
    unclear: float = 3.0
    undecided_s: float = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class ExistenceConfig:
    """When a track exists, by log-odds that add up over images, and what is remembered of it.

    Attributes:
        weakest: least score of detections that are used.
        trust: weight of a score: the detector is overconfident on cameras unlike those it was trained on.
        lasting: added to each score: a faint detection that repeats is wrong more often
            than single images say.
        birth: least score of a detection that initiates a track.
        independent_s: time after which two images of a moving person are independent evidence.
        still_s: the same for a stationary person, whose images repeat.
        look_m: distance after which the appearance is new evidence.
        evidence_gain: weight of how much surer an image is than all before, counted at once: a person who
            appears from behind a door looks different in the next image.
        highest_score: greatest evidence of one image.
        shared_doubt: taken off the score of a new track whose box lies within that of another, from its
            second image on.
        highest: greatest log-odds.
        sightings: detections needed for confirmation.
        at_once: score of a single detection that suffices instead.
        confirmed: log-odds at which a track is confirmed.
        deletion_log_odds: log-odds below which a track is deleted.
        missed: loss for an image without a detection of a visible track.
        missed_hidden: the same for an occluded track.
        absent: the same for a track where the background is visible.
        max_coast_s: how long an unoccluded track is output without a detection.
        max_coast_occluded_s: the same for an occluded track.
        max_coast_covered_s: the same while the track's box still lies on that of a person who is seen.
        covered: least overlap of these boxes.
        coast_occluded_share: the same, as a share of its observed time: a false track next to a person seems
            to be occluded by the person in the end.
        max_present_s: how long a visible part of an occluded track counts like a detection.
        forget_s: a track unseen for so long is deleted.
        brief_s: a track observed for less time is brief.
        brief_forget_s: a brief track is deleted sooner.
        taken: overlap with a track at which a detection initiates no other one.
        learning: weight of a new image in the remembered appearance, width and confidence.
        learning_recent: the same in the recent colours that are compared with it.
        learning_edges: the same in the edges of the whole person, which change with each step.
        own_colours: Bhattacharyya coefficient above which recent colours are the person's own.
    """

    weakest: float = -2.0
    trust: float = 0.8
    lasting: float = -0.2
    birth: float = -0.5
    independent_s: float = 0.25
    still_s: float = 4.0
    look_m: float = 0.25
    evidence_gain: float = 0.4
    highest_score: float = 3.0
    shared_doubt: float = 2.0
    highest: float = 8.0
    sightings: int = 2
    at_once: float = 3.0
    confirmed: float = 2.0
    deletion_log_odds: float = -0.5
    missed: float = 1.0
    missed_hidden: float = 0.3
    absent: float = 4.0
    max_coast_s: float = 0.25
    max_coast_occluded_s: float = 1.0
    max_coast_covered_s: float = 5.0
    covered: float = 0.4
    coast_occluded_share: float = 0.5
    max_present_s: float = math.inf
    forget_s: float = 10.0
    brief_s: float = 1.0
    brief_forget_s: float = 2.0
    taken: float = 0.45
    learning: float = 0.1
    learning_recent: float = 0.2
    learning_edges: float = 0.4
    own_colours: float = 0.7


@dataclass(frozen=True, slots=True, kw_only=True)
class ColourDetectionConfig:
    """Use of the detector, which was trained on thermal images, on the colour image.

    Attributes:
        every_s: least time between two searches of the colour image.
        beside_s: the same while the thermal image shows people.
        alone_every_s: the same while only the colour image shows some person.
        believed: weight of its log-odds.
        same: IoU from which detections of both cameras are one person.
        shared: greatest overlap, in shares of the smaller box, of a separate person in the colour image.
        alone: least score of a person in the colour image alone.
    """

    every_s: float = 0.79
    beside_s: float = 1.59
    alone_every_s: float = 0.19
    believed: float = 0.85
    same: float = 0.45
    shared: float = 0.65
    alone: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class DetectorScoreConfig:
    """How the scores of a user's detector become log-odds.

    Attributes:
        most: greatest log-odds, positive or negative: a single detection confirms no track.
        unscored: probability of a detection without a score.
    """

    most: float = 3.9
    unscored: float = 0.88


@dataclass(frozen=True, slots=True, kw_only=True)
class PeopleTrackerConfig:
    """All settings of the people tracker.

    Attributes:
        motion: motion and measurement noise.
        schedule: when the detector runs.
        association: cost of an assignment.
        existence: confirmation and deletion.
        reidentification: recognition and identity swaps.
        schedule_uncalibrated: schedule without calibration: every image is searched.
        existence_uncalibrated: existence without calibration, where detections are less reliable and no floor
            constrains them.
        association_uncalibrated: association without calibration, where colours do not tell people apart.
        reidentification_uncalibrated: reidentification without calibration, where boxes fit the colour
            image less well.
        existence_depth: evidence of the depth image.
        association_depth: association in the depth image.
        existence_panorama: evidence of the panorama.
        association_panorama: association in the panorama.
        existence_laser: evidence of the laser range finder.
        association_laser: association in its scans.
        colour: use of the colour image.
        detector_scores: use of the scores of a user's detector.
        stops_hidden: whether a hidden person who would be visible where the track is predicted stopped.
        hidden_share: share of a track that something nearer covers, from which it is hidden.
    """

    motion: KalmanConfig = field(default_factory=KalmanConfig)
    schedule: DetectionScheduleConfig = field(default_factory=DetectionScheduleConfig)
    association: AssociationConfig = field(default_factory=AssociationConfig)
    existence: ExistenceConfig = field(default_factory=ExistenceConfig)
    reidentification: ReidentificationConfig = field(default_factory=ReidentificationConfig)
    schedule_uncalibrated: DetectionScheduleConfig = field(
        default_factory=lambda: DetectionScheduleConfig(unsettled_s=0.0, settled_s=0.0, anew_s=0.0)
    )
    existence_uncalibrated: ExistenceConfig = field(
        default_factory=lambda: ExistenceConfig(
            lasting=0.0,
            birth=0.5,
            sightings=4,
            at_once=math.inf,
            confirmed=2.3,
            shared_doubt=4.0,
            max_coast_occluded_s=0.5,
            max_coast_covered_s=0.5,
            coast_occluded_share=math.inf,
        )
    )
    association_uncalibrated: AssociationConfig = field(
        default_factory=lambda: AssociationConfig(highest=2.3, lost_s=4.0)
    )
    reidentification_uncalibrated: ReidentificationConfig = field(
        default_factory=lambda: ReidentificationConfig(same=0.65, uses_place=False)
    )
    existence_depth: ExistenceConfig = field(default_factory=ExistenceConfig)
    association_depth: AssociationConfig = field(
        default_factory=lambda: AssociationConfig(overlap=0.0, highest=2.4)
    )
    existence_panorama: ExistenceConfig = field(default_factory=ExistenceConfig)
    association_panorama: AssociationConfig = field(
        default_factory=lambda: AssociationConfig(overlap=0.0, highest=2.4)
    )
    existence_laser: ExistenceConfig = field(default_factory=ExistenceConfig)
    association_laser: AssociationConfig = field(
        default_factory=lambda: AssociationConfig(overlap=0.0, highest=2.4)
    )
    colour: ColourDetectionConfig = field(default_factory=ColourDetectionConfig)
    detector_scores: DetectorScoreConfig = field(default_factory=DetectorScoreConfig)
    stops_hidden: bool = True
    hidden_share: float = 0.4


_LONG_MEMORY: Final = ExistenceConfig(max_coast_occluded_s=0.4, forget_s=30.0, brief_forget_s=10.0)
_ALL_ROUND: Final = ExistenceConfig(
    birth=-1.0,
    highest_score=8.0,
    sightings=3,
    at_once=math.inf,
    confirmed=3.0,
    max_coast_s=0.7,
    max_coast_occluded_s=5.0,
    coast_occluded_share=math.inf,
    forget_s=20.0,
    brief_forget_s=10.0,
)
_UNKNOWN_IS_OTHER: Final = ReidentificationConfig(colour_unknown=-2.0, least=1.0)

LIVE: Final = PeopleTrackerConfig(
    schedule_uncalibrated=DetectionScheduleConfig(unsettled_s=0.045, settled_s=0.045, anew_s=0.0)
)
"""Settings for cameras of 25 Hz or more, of which every second image or fewer are searched as a whole."""

ATTENTIVE: Final = PeopleTrackerConfig(
    existence=ExistenceConfig(forget_s=600.0),
    reidentification=ReidentificationConfig(colour_unknown=-2.0),
)
"""Settings for people who come back after minutes, chosen on seeds 102 to 107 of `absence_60s`."""

FUSED: Final = PeopleTrackerConfig(
    motion=KalmanConfig(nearest_m=-math.inf),
    existence_panorama=_ALL_ROUND,
    existence=_LONG_MEMORY,
    existence_depth=_LONG_MEMORY,
    association=AssociationConfig(lost_s=0.5),
    association_depth=AssociationConfig(overlap=0.0, highest=2.4, lost_s=0.5),
    reidentification=_UNKNOWN_IS_OTHER,
)
"""Settings for several sensors, chosen on seeds 100 and 101 of the suite `occlusion`."""

PANORAMIC: Final = PeopleTrackerConfig(
    motion=KalmanConfig(acceleration_m_s2=(0.45, 0.2, 0.45), nearest_m=-math.inf),
    existence_panorama=_ALL_ROUND,
    reidentification=_UNKNOWN_IS_OTHER,
    stops_hidden=False,
)
"""Settings for the panorama alone, chosen on seeds 100 to 102 of the scenarios `panoramic_...`."""

RGBD: Final = replace(
    FUSED,
    existence_depth=replace(
        _LONG_MEMORY,
        at_once=1.0,
        confirmed=0.6,
        max_coast_s=0.8,
        max_coast_occluded_s=1.0,
        max_present_s=2.0,
    ),
)
"""Settings for a depth camera with colour alone, whose classifier rarely errs.

Chosen on seed 100 of the drives of `peopleboy reproduce --paper situation`, and of the suite `occlusion`.
"""

SCANNED: Final = PeopleTrackerConfig(
    motion=KalmanConfig(nearest_m=-math.inf),
    existence_laser=ExistenceConfig(
        sightings=3,
        at_once=math.inf,
        max_coast_s=0.7,
        max_coast_occluded_s=3.0,
        coast_occluded_share=math.inf,
    ),
)
"""Settings for a laser range finder alone, where neither height nor colours are known."""
