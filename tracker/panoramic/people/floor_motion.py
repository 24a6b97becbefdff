"""Motion of people on the floor: a Kalman filter of position and velocity."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]

FIRST_SPEED_SD_M_S: Final = 0.7
FASTEST_M_S: Final = 2.5


@dataclass(frozen=True, slots=True, eq=False)
class FloorMotion:
    """State estimate of a person's motion at one instant.

    Attributes:
        state: (4,) x, y [m], and their velocities [m/s] in room coordinates.
        covariance: (4, 4) of the state.
    """

    state: Floats
    covariance: Floats

    @property
    def place_m(self) -> Floats:
        """(2,) [m]."""
        return self.state[:2]

    @property
    def place_m2(self) -> Floats:
        """(2, 2) covariance of the position [m2]."""
        return self.covariance[:2, :2]

    @classmethod
    def begin(cls, place_m: Floats, error_m2: Floats) -> "FloorMotion":
        """Initiate at a measured position (2,) with a covariance (2, 2) and an unknown walking velocity."""
        covariance = np.zeros((4, 4))
        covariance[:2, :2] = error_m2
        covariance[2, 2] = covariance[3, 3] = FIRST_SPEED_SD_M_S**2
        return cls(np.concatenate([place_m, np.zeros(2)]), covariance)

    def later(self, dt_s: float, restlessness: float) -> "FloorMotion":
        """Predict with white acceleration of this spectral density [m2/s3].

        Source: Bar-Shalom, Li, Kirubarajan, Estimation with Applications to Tracking and Navigation, 6.2.2.
        """
        return FloorMotion(*_later(self.state, self.covariance, dt_s, restlessness))

    def corrected(self, place_m: Floats, error_m2: Floats) -> "FloorMotion":
        """Update with a measured position (2,) [m] with this covariance (2, 2) [m2]."""
        (a, b), (c, d) = (self.place_m2 + error_m2).tolist()
        gain = self.covariance[:, :2] @ (np.array([[d, -b], [-c, a]]) / (a * d - b * c))
        state = self.state + gain @ (place_m - self.place_m)
        speed = float(np.hypot(state[2], state[3]))
        if speed > FASTEST_M_S:
            state[2:] *= FASTEST_M_S / speed
        covariance = self.covariance - gain @ self.covariance[:2]
        return FloorMotion(state, (covariance + covariance.T) / 2.0)

    def slowed(self, dt_s: float, tau_s: float) -> "FloorMotion":
        """Decay the velocity, as unseen people rarely walk straight for long."""
        state = self.state.copy()
        state[2:] *= np.exp(-dt_s / tau_s)
        return FloorMotion(state, self.covariance)


@njit(cache=True, nogil=True)
def _later(state: Floats, covariance: Floats, dt_s: float, restlessness: float) -> tuple[Floats, Floats]:
    state, covariance = state.copy(), covariance.copy()
    state[:2] += dt_s * state[2:]
    covariance[:2] += dt_s * covariance[2:]
    covariance[:, :2] += dt_s * covariance[:, 2:]
    for k in range(2):
        covariance[k, k] += restlessness * dt_s**3 / 3.0
        covariance[k, k + 2] += restlessness * dt_s**2 / 2.0
        covariance[k + 2, k] += restlessness * dt_s**2 / 2.0
        covariance[k + 2, k + 2] += restlessness * dt_s
    return state, covariance
