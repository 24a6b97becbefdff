"""Settings of the scene model."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True, kw_only=True)
class LayersConfig:
    """How readings are sorted into background and things.

    Attributes:
        confirm: agreeing readings in a row that are believed.
        least_m, most_m: [m] within which two readings of one surface agree, at least and at most.
        deviations: the same in standard deviations of the noise of raw readings, of which smoothing leaves
            half.
        memory: share of the estimated noise that is kept from frame to frame.
    """

    confirm: int = 5
    least_m: float = 0.03
    deviations: float = 2.5
    most_m: float = 0.25
    memory: float = 0.9


@dataclass(frozen=True, slots=True, kw_only=True)
class PeopleMaskConfig:
    """How people are separated from things.

    Attributes:
        has_heat: whether the thermal image shows them, as far as it sees; by their shape everywhere if not.
        warm: grey of the thermal image from which on something is as warm as people are.
        grown_px: [px] by which what is warm grows over what is connected with it.
        least_m2: [m^2] area of the smallest piece of a person.
        gap_m: [m] of depth between neighbouring pixels of one body.
        clear_m: [m] that a person stands before the background at least; by shape.
        top_m, wide_m: [m] a person's head is above, and how wide a person is at most; by shape.
        column_m: [m] radius in which a known person's pixels lie where a thing is connected with it.
        below_m: [m] the same below a person who is found.
        moved_m: [m] way after which something of a person's shape is believed to be one.
        doubt_s: [s] after which it is taken for a thing if it has not moved.
        gate_m, gate_m_s: [m] from one frame to the next, and [m/s] for each second without a sight.
        kept_s: [s] for which a person is remembered who is not seen.
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
    """How pixels become things, and what happens to things becomes known.

    Attributes:
        off_m: [m] that a thing stands before its background at least.
        gap_m: [m] of depth between neighbouring pixels of one thing.
        slack_s: [s] between the times in which two neighbouring pixels may have changed together.
        least_px: [px] of the smallest thing.
        least_m2: [m^2] of the smallest thing.
        beside_m, beside_s: [m] on the floor, and [s], between parts of one thing that are not connected in
            the image.
        settled_s: [s] for which a thing must stay as it is before it is reported.
        growth: share by which it may grow meanwhile.
        left: share of a thing's largest area below which it is gone.
        pair_s: [s] from a thing's vanishing until it appears elsewhere, at most.
        wait_s: [s] for which a change is held back for its other half.
        hold_s: [s] for which what appears beside a person may still be in their hands.
        unseen_s: [s] out of sight from which on nothing new is reported of a thing.
        size_ratio: of areas and heights of what may be the same thing.
        colour: distance of mean colours, of 255, that halves how alike two things are.
        hand_m: [m] from a person on the floor to what they move.
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
    """Settings of the whole model.

    Attributes:
        layers: of background and things.
        people: of the mask of people.
        things: of things and what happens to them.
        still_m, still_rad: motion of the robot in a frame up to which it stands.
        still_s: [s] for which it must stand before a new place is learned.
        joins: whether places are registered with each other, or joined by odometry alone.
    """

    layers: LayersConfig = field(default_factory=LayersConfig)
    people: PeopleMaskConfig = field(default_factory=PeopleMaskConfig)
    things: ThingsConfig = field(default_factory=ThingsConfig)
    still_m: float = 0.004
    still_rad: float = 0.004
    still_s: float = 0.3
    joins: bool = True
