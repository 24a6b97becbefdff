"""The paper's Kalman filter over a person's position on the floor, equations 1 to 10."""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.small_matrices import inverse

Floats = NDArray[np.float64]

STEP_S = 1.0 / 3.0
"""Time step of the paper's images [s], to which Q refers."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MotionNoise:
    """Covariances of the filter.

    Attributes:
        step_m2: Q, (2, 2) process noise of a step of `STEP_S` [m2].
        measurement_m2: R, (2, 2) measurement noise of a position [m2].
    """

    step_m2: Floats
    measurement_m2: Floats


PRINTED = MotionNoise(
    step_m2=np.array([[0.024, -0.001], [-0.001, 0.043]]),
    measurement_m2=np.array([[0.011, -0.004], [-0.004, 0.020]]),
)
"""Equation 10. Q is as large as the spread of a walker's whole steps, as if no velocity were known."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Estimate:
    """State estimate of a person at one instant.

    Attributes:
        position_m: (2,) in room coordinates [m].
        covariance_m2: P, (2, 2) [m2].
        velocity_m: (2,) u, displacement in a step of `STEP_S` [m].
    """

    position_m: Floats
    covariance_m2: Floats
    velocity_m: Floats = field(default_factory=lambda: np.zeros(2))


@dataclass(frozen=True, slots=True)
class PositionFilter:
    """Settings of the filter.

    The paper calls u both "the nominal velocity" and the estimated one, and does not define its source.

    Attributes:
        noise: Q and R.
        uses_velocity: whether u is the last estimated step; otherwise it is 0.
    """

    noise: MotionNoise
    uses_velocity: bool

    def start(self, measured_m: Floats) -> Estimate:
        """Initiate with the first measured position (2,) [m]."""
        return Estimate(position_m=measured_m, covariance_m2=self.noise.measurement_m2)

    def predict(self, before: Estimate, steps: float = 1.0) -> Estimate:
        """Predict over a number of steps of `STEP_S`."""
        return Estimate(
            position_m=before.position_m + steps * before.velocity_m,  # Eq. 5
            covariance_m2=before.covariance_m2 + steps * self.noise.step_m2,  # Eq. 6
            velocity_m=before.velocity_m,
        )

    def update(self, before: Estimate, measured_m: Floats, steps: float = 1.0) -> Estimate:
        """Update with a position (2,) [m] measured a number of steps after the last one."""
        expected = self.predict(before, steps)
        gain = expected.covariance_m2 @ inverse(expected.covariance_m2 + self.noise.measurement_m2)  # Eq. 9
        position = expected.position_m + gain @ (measured_m - expected.position_m)  # Eq. 7
        return Estimate(
            position_m=position,
            covariance_m2=(np.eye(2) - gain) @ expected.covariance_m2,  # Eq. 8
            velocity_m=(position - before.position_m) / steps if self.uses_velocity else np.zeros(2),
        )


def estimate_noise(walks: Iterable[tuple[Floats, Floats]], *, uses_velocity: bool) -> MotionNoise:
    """Estimate Q and R from walks of three or more steps of `STEP_S`, each true and measured (N, 2) [m].

    With a velocity, Q is the spread of true steps around the last measured step: a filter only has an
    estimate of that step, and diverges if it takes it for exact.
    """
    unknown, errors = [], []
    for true, measured in walks:
        steps = np.diff(true, axis=0)
        unknown.append(steps[1:] - np.diff(measured, axis=0)[:-1] if uses_velocity else steps)
        errors.append(measured - true)
    return MotionNoise(
        step_m2=np.cov(np.concatenate(unknown), rowvar=False),
        measurement_m2=np.cov(np.concatenate(errors), rowvar=False),
    )
