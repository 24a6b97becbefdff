"""Settings of the scene model."""

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True, kw_only=True)
class LayersConfig:
    """How readings are assigned to background and objects.

    Attributes:
        confirm: number of consecutive agreeing readings needed.
        least_m, most_m: [m] limits of the tolerance between two readings of one surface.
        deviations: the tolerance in standard deviations of raw readings; smoothing halves the noise.
        memory: weight of the previous noise estimate.
    """

    confirm: int = 5
    least_m: float = 0.03
    deviations: float = 2.5
    most_m: float = 0.25
    memory: float = 0.9


@dataclass(frozen=True, slots=True, kw_only=True)
class PeopleMaskConfig:
    """How people are separated from objects.

    Attributes:
        has_heat: whether people are detected by the thermal image where it covers them; else by shape.
        warm: grey of the thermal image from which a surface is as warm as people.
        grown_px: [px] by which warm regions grow over connected pixels.
        least_m2: [m^2] area of the smallest part of a person.
        gap_m: [m] of depth between neighbouring pixels of one body.
        clear_m: [m] least distance of a person from the background; by shape.
        top_m, wide_m: [m] least height of a person's head, and greatest width; by shape.
        column_m: [m] radius of a known person's pixels in a component that includes an object.
        below_m: [m] the same below a detected person.
        moved_m: [m] distance moved after which an object of a person's shape is a person.
        doubt_s: [s] after which it is an object if it has not moved.
        gate_m, gate_m_s: [m] between frames, and [m/s] growth without a detection.
        kept_s: [s] after which an undetected person is forgotten.
    """

    has_heat: bool = True
    warm: float = 255.0 * (25.0 - 24.0) / (36.0 - 24.0)
    grown_px: int = 3
    least_m2: float = 0.02
    gap_m: float = 0.12
    clear_m: float = 0.12
    top_m: float = 1.15
    wide_m: float = 0.95
    column_m: float = 0.3
    below_m: float = 0.2
    moved_m: float = 0.25
    doubt_s: float = 2.0
    gate_m: float = 0.5
    gate_m_s: float = 1.5
    kept_s: float = 2.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ThingsConfig:
    """How pixels become objects, and how changes are confirmed.

    Attributes:
        off_m: [m] least distance of an object from its background.
        gap_m: [m] of depth between neighbouring pixels of one object.
        slack_s: [s] tolerance between the changes of neighbouring pixels of one object.
        least_px: [px] of the smallest object.
        least_m2: [m^2] of the smallest object.
        beside_m, beside_s: [m] on the floor, and [s], between parts of one object that are not connected in
            the image.
        settled_s: [s] for which an object must stay unchanged before it is reported.
        growth: share by which it may grow meanwhile.
        left: share of an object's largest area below which it is gone.
        pair_s: [s] longest time between an object's disappearance and its reappearance elsewhere.
        wait_s: [s] for which a change waits for its counterpart.
        hold_s: [s] for which an object that appears next to a person may still be in the person's hands.
        unseen_s: [s] out of sight after which no changes of an object are reported.
        size_ratio: greatest ratio of areas and heights of one object.
        colour: distance of mean colours, of 255, that halves the similarity of two objects.
        hand_m: [m] from a person's position on the floor to a moved object.
    """

    off_m: float = 0.08
    gap_m: float = 0.1
    slack_s: float = 0.35
    least_px: int = 40
    least_m2: float = 0.01
    beside_m: float = 0.55
    beside_s: float = 1.0
    settled_s: float = 0.8
    growth: float = 0.15
    left: float = 0.3
    pair_s: float = 15.0
    wait_s: float = 1.5
    hold_s: float = 2.5
    unseen_s: float = 0.5
    size_ratio: float = 2.5
    colour: float = 40.0
    hand_m: float = 1.3


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneConfig:
    """Settings of the scene model.

    Attributes:
        layers: settings of background and objects.
        people: settings of the mask of people.
        things: settings of objects and their changes.
        still_m, still_rad: motion in a frame up to which the robot counts as standing.
        still_s: [s] of standing before a new place is learned.
        joins: whether places are registered with each other, or joined by odometry alone.
    """

    layers: LayersConfig = field(default_factory=LayersConfig)
    people: PeopleMaskConfig = field(default_factory=PeopleMaskConfig)
    things: ThingsConfig = field(default_factory=ThingsConfig)
    still_m: float = 0.004
    still_rad: float = 0.004
    still_s: float = 0.3
    joins: bool = True
