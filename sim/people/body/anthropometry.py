"""Sizes of a human body from stature, sex and build."""

import math
from dataclasses import dataclass
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
# The word names the factor by which builds differ.
_SURVEY: dict[str, tuple[float, float, str]] = {
    "bideltoid_breadth": (0.290, 0.276, "bideltoid"),
    "chest_breadth": (0.165, 0.164, "chest"),
    "chest_depth": (0.145, 0.151, "chest"),
    "waist_breadth": (0.186, 0.185, "waist"),
    "waist_depth": (0.137, 0.133, "waist"),
    "hip_breadth": (0.197, 0.213, "hip"),
    "buttock_depth": (0.142, 0.142, "buttock"),
    "head_breadth": (0.088, 0.090, "bone"),
    "head_length": (0.113, 0.115, "bone"),
    "neck_circumference": (0.226, 0.203, "joint"),
    "biceps_circumference": (0.204, 0.188, "limb"),
    "forearm_circumference": (0.176, 0.162, "limb"),
    "wrist_circumference": (0.100, 0.095, "bone"),
    "thigh_circumference": (0.356, 0.379, "limb"),
    "lower_thigh_circumference": (0.234, 0.240, "limb"),
    "calf_circumference": (0.223, 0.230, "limb"),
    "ankle_circumference": (0.130, 0.132, "joint"),
}
MEAN_GIRTHS: dict[Sex, Girths] = {
    "male": Girths(**{name: male for name, (male, _, _) in _SURVEY.items()}),
    "female": Girths(**{name: female for name, (_, female, _) in _SURVEY.items()}),
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
    factor = {"bone": 1.0, **_BUILD_FACTORS[build]}
    factor["joint"] = math.sqrt(factor["limb"])
    girths = {name: getattr(MEAN_GIRTHS[sex], name) * factor[kind] for name, (_, _, kind) in _SURVEY.items()}
    return BodySize(stature_m=stature_m, sex=sex, girths=Girths(**girths))
