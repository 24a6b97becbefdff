"""Sizes of a human body from stature, sex and build."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

Sex = Literal["female", "male"]
Build = Literal["slim", "average", "stout"]

# Heights and lengths of segments as fractions of stature: Drillis and Contini (1966), as reproduced in
# Winter, Biomechanics and Motor Control of Human Movement, figure 4.1. Both sexes.
ANKLE_HEIGHT = 0.039
KNEE_HEIGHT = 0.285
HIP_HEIGHT = 0.530
SHOULDER_HEIGHT = 0.818
CHIN_HEIGHT = 0.870
EYE_HEIGHT = 0.936
UPPER_ARM_LENGTH = 0.186
FOREARM_LENGTH = 0.146
HAND_LENGTH = 0.108
FOOT_LENGTH = 0.152
FOOT_BREADTH = 0.055


@dataclass(frozen=True, slots=True, kw_only=True)
class Girths:
    """Breadths, depths and circumferences as fractions of stature.

    Breadths run from side to side, depths from back to front; names are those of the survey.
    """

    bideltoid_breadth: float
    chest_breadth: float
    chest_depth: float
    waist_breadth: float
    waist_depth: float
    hip_breadth: float
    buttock_depth: float
    head_breadth: float
    head_length: float
    neck_circumference: float
    biceps_circumference: float
    forearm_circumference: float
    wrist_circumference: float
    thigh_circumference: float
    lower_thigh_circumference: float
    calf_circumference: float
    ankle_circumference: float


# Rounded means over rounded mean stature (1756 mm men, 1629 mm women), after ANSUR II, the 2012
# anthropometric survey of US Army personnel: Gordon et al. (2014), NATICK/TR-15/007.
MEAN_GIRTHS: dict[Sex, Girths] = {
    "male": Girths(
        bideltoid_breadth=0.290,
        chest_breadth=0.165,
        chest_depth=0.145,
        waist_breadth=0.186,
        waist_depth=0.137,
        hip_breadth=0.197,
        buttock_depth=0.142,
        head_breadth=0.088,
        head_length=0.113,
        neck_circumference=0.226,
        biceps_circumference=0.204,
        forearm_circumference=0.176,
        wrist_circumference=0.100,
        thigh_circumference=0.356,
        lower_thigh_circumference=0.234,
        calf_circumference=0.223,
        ankle_circumference=0.130,
    ),
    "female": Girths(
        bideltoid_breadth=0.276,
        chest_breadth=0.164,
        chest_depth=0.151,
        waist_breadth=0.185,
        waist_depth=0.133,
        hip_breadth=0.213,
        buttock_depth=0.142,
        head_breadth=0.090,
        head_length=0.115,
        neck_circumference=0.203,
        biceps_circumference=0.188,
        forearm_circumference=0.162,
        wrist_circumference=0.095,
        thigh_circumference=0.379,
        lower_thigh_circumference=0.240,
        calf_circumference=0.230,
        ankle_circumference=0.132,
    ),
}

# Factors on the means. Fat goes to the waist first; bones, and with them head and wrists, hardly change.
_BUILD_FACTORS: dict[Build, dict[str, float]] = {
    "slim": {"bideltoid": 0.94, "chest": 0.90, "waist": 0.82, "hip": 0.91, "buttock": 0.88, "limb": 0.90},
    "average": {"bideltoid": 1.0, "chest": 1.0, "waist": 0.95, "hip": 1.0, "buttock": 1.0, "limb": 1.0},
    "stout": {"bideltoid": 1.06, "chest": 1.13, "waist": 1.24, "hip": 1.11, "buttock": 1.16, "limb": 1.09},
}


@dataclass(frozen=True, slots=True, kw_only=True)
class BodySize:
    """One body: stature [m] and its girths as fractions of stature."""

    stature_m: float
    sex: Sex
    girths: Girths

    def radius_of(self, circumference: float) -> float:
        """Radius [m] of a round limb whose circumference is a fraction of stature."""
        return circumference / (2.0 * math.pi) * self.stature_m


def measure(stature_m: float, sex: Sex, build: Build) -> BodySize:
    """Look up the sizes of a body.

    Our addition to the survey's means: builds are factors on them, chosen so that the waist spans what the
    survey's 5th to 95th percentiles span.
    """
    mean, factor = MEAN_GIRTHS[sex], _BUILD_FACTORS[build]
    limb = factor["limb"]
    girths = replace(
        mean,
        bideltoid_breadth=mean.bideltoid_breadth * factor["bideltoid"],
        chest_breadth=mean.chest_breadth * factor["chest"],
        chest_depth=mean.chest_depth * factor["chest"],
        waist_breadth=mean.waist_breadth * factor["waist"],
        waist_depth=mean.waist_depth * factor["waist"],
        hip_breadth=mean.hip_breadth * factor["hip"],
        buttock_depth=mean.buttock_depth * factor["buttock"],
        neck_circumference=mean.neck_circumference * math.sqrt(limb),
        biceps_circumference=mean.biceps_circumference * limb,
        forearm_circumference=mean.forearm_circumference * limb,
        thigh_circumference=mean.thigh_circumference * limb,
        lower_thigh_circumference=mean.lower_thigh_circumference * limb,
        calf_circumference=mean.calf_circumference * limb,
        ankle_circumference=mean.ankle_circumference * math.sqrt(limb),
    )
    return BodySize(stature_m=stature_m, sex=sex, girths=girths)
