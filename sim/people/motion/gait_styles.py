"""Styles of walking and running: how a person's manner differs from that of an average adult."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final, Literal

from peopleboy.sim.people.motion.manner import Manner

GaitName = Literal["usual", "strolling", "brisk", "old", "heavy", "shuffling", "running"]


@dataclass(frozen=True, slots=True, kw_only=True)
class GaitStyle:
    """Differences of a gait from the usual one.

    Attributes:
        stride, arm_swing, sways, clearance: factors of the same attributes of `Manner`.
        arms_off_deg, elbow_deg, stoop_deg, bow_deg, toe_out_deg: additional angles.
        step_width: additional distance of the feet, relative to that of the hip joints.
        bent_knees: reduction of the longest reach of a leg, in leg lengths.
        runs: see `Manner`.
    """

    stride: float = 1.0
    arm_swing: float = 1.0
    sways: float = 1.0
    clearance: float = 1.0
    arms_off_deg: float = 0.0
    elbow_deg: float = 0.0
    stoop_deg: float = 0.0
    bow_deg: float = 0.0
    toe_out_deg: float = 0.0
    step_width: float = 0.0
    bent_knees: float = 0.0
    runs: bool = False

    def applied_to(self, manner: Manner) -> Manner:
        """Return the manner of a person with this gait."""
        bow, aside = manner.head_rad
        return replace(
            manner,
            stride=manner.stride * self.stride,
            arm_swing=manner.arm_swing * self.arm_swing,
            sways=manner.sways * self.sways,
            clearance=manner.clearance * self.clearance,
            arms_off_rad=manner.arms_off_rad + math.radians(self.arms_off_deg),
            elbow_rad=manner.elbow_rad + math.radians(self.elbow_deg),
            stoop_rad=manner.stoop_rad + math.radians(self.stoop_deg),
            head_rad=(bow + math.radians(self.bow_deg), aside),
            toe_out_rad=manner.toe_out_rad + math.radians(self.toe_out_deg),
            narrows=manner.narrows - self.step_width,
            bent_knees=manner.bent_knees + self.bent_knees,
            runs=manner.runs or self.runs,
        )


# Old men walk with shorter steps, toes further out, less swing of the arms and lower lift of the feet
# (Murray, Kory and Clarkson 1969, Walking patterns in healthy old men); obese men with shorter and much wider
# steps (Spyropoulos et al. 1991, Biomechanical gait analysis in obese men). People with Parkinson's disease
# shuffle with flexed trunk, knees and elbows (Murray et al. 1978, Walking patterns of men with parkinsonism).
# The figures are our choice.
GAIT_STYLES: Final[Mapping[GaitName, GaitStyle]] = {
    "usual": GaitStyle(),
    "strolling": GaitStyle(stride=0.93, arm_swing=0.6, sways=1.15),
    "brisk": GaitStyle(stride=1.08, arm_swing=1.45, elbow_deg=22.0, stoop_deg=3.0),
    "old": GaitStyle(
        stride=0.78, arm_swing=0.5, clearance=0.6, elbow_deg=14.0, stoop_deg=14.0, bow_deg=8.0,
        toe_out_deg=4.0, step_width=0.25, bent_knees=0.012,
    ),
    "heavy": GaitStyle(
        stride=0.88, arm_swing=0.8, sways=1.9, arms_off_deg=9.0, stoop_deg=-2.0, toe_out_deg=6.0,
        step_width=0.45,
    ),
    "shuffling": GaitStyle(
        stride=0.5, arm_swing=0.15, clearance=0.1, elbow_deg=38.0, stoop_deg=22.0, bow_deg=12.0,
        bent_knees=0.03,
    ),
    "running": GaitStyle(runs=True),
}  # fmt: skip
