"""Measurements of people by the sensors, and how they initiate and update the motion filter."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.tracking.config import STATURE_M, KalmanConfig
from peopleboy.tracker.tracking.motion_filter import (
    STATE,
    Floats,
    Linearised,
    StateEstimates,
    constrain_to_floor,
    initiate,
    linearise,
    mahalanobis,
    update,
)
from peopleboy.tracker.tracking.viewpoint import Viewpoint

Rows = NDArray[np.intp] | Sequence[int]


class Measurement(Protocol):
    """M measurements of one image, each of one person."""

    def distances(self, states: StateEstimates) -> Floats:
        """Return the Mahalanobis distances (K, M) of the measurements from K predicted states."""
        ...

    def update(self, states: StateEstimates, chosen: Rows) -> StateEstimates:
        """Update K states, each with one of the measurements (K,)."""
        ...

    def initiate(self, chosen: Rows) -> StateEstimates:
        """Initiate states from some of the measurements; their velocities are unknown."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class BoxMeasurement:
    """Bounding boxes in the image of a planar camera: middle column, and rows of head and feet.

    Attributes:
        boxes: (M, 4) [px].
        view: of the camera.
        config: noise, in box heights.
    """

    boxes: Floats
    view: Viewpoint
    config: KalmanConfig

    def distances(self, states: StateEstimates) -> Floats:
        """Return the Mahalanobis distances (K, M) of the boxes from K predicted states."""
        expected = linearise(states, self.view)
        height = np.maximum(expected.values[:, 2:] - expected.values[:, 1:2], 1.0)
        return mahalanobis(states, expected, np.square(height * self._deviations), _ends(self.boxes))

    def update(self, states: StateEstimates, chosen: Rows) -> StateEstimates:
        """Update K states, each with one of the boxes (K,), and with feet on the floor where it is known."""
        boxes = self.boxes[np.asarray(chosen, np.intp)]
        noise = np.square(boxes[:, 3:] * self._deviations)
        return self._on_floor(update(states, linearise(states, self.view), noise, _ends(boxes)))

    def initiate(self, chosen: Rows) -> StateEstimates:
        """Initiate states from some of the boxes; the velocity is unknown."""
        boxes = self.boxes[np.asarray(chosen, np.intp)]
        noise = np.square(boxes[:, 3:] * self._deviations)
        return self._on_floor(initiate(boxes, noise, self.view, self.config))

    @property
    def _deviations(self) -> Floats:
        """Standard deviations (3,), in box heights."""
        return np.array([self.config.column, self.config.head, self.config.foot])

    def _on_floor(self, states: StateEstimates) -> StateEstimates:
        if self.view.floor_m is None:
            return states
        return constrain_to_floor(states, self.view.floor_m, self.config.floor_m)


@dataclass(frozen=True, slots=True, eq=False)
class FloorMeasurement:
    """Positions on the floor, and heights of heads.

    Attributes:
        places_m: (M, 2) to the right and ahead in the level frame.
        heads_m: (M,) height above the floor.
        deviations_m: (M, 3) standard deviations across and along the line of sight, and of the head.
        seen_from_m: (2,) position of the sensor, to the right and ahead.
        floor_m: depth of the floor below the origin of the level frame.
        config: of the motion filter.
    """

    places_m: Floats
    heads_m: Floats
    deviations_m: Floats
    seen_from_m: Floats
    floor_m: float
    config: KalmanConfig

    def distances(self, states: StateEstimates) -> Floats:
        """Return the Mahalanobis distances (K, M) of the positions from K predicted states."""
        result = np.empty((len(states), len(self.places_m)))
        for column in range(len(self.places_m)):
            chosen = np.full(len(states), column)
            noise = np.square(self.deviations_m[chosen])
            values = self._values(chosen)[:1]
            result[:, column] = mahalanobis(states, self._linearise(states, chosen), noise, values)[:, 0]
        return result

    def update(self, states: StateEstimates, chosen: Rows) -> StateEstimates:
        """Update K states, each with one of the positions (K,), and with feet on the floor."""
        chosen = np.asarray(chosen, np.intp)
        noise = np.square(self.deviations_m[chosen])
        later = update(states, self._linearise(states, chosen), noise, self._values(chosen))
        return constrain_to_floor(later, self.floor_m, self.config.floor_m)

    def initiate(self, chosen: Rows) -> StateEstimates:
        """Initiate states from some of the positions; the velocity is unknown."""
        chosen = np.asarray(chosen, np.intp)
        config, count = self.config, len(chosen)
        mean, covariance = np.zeros((count, STATE)), np.zeros((count, STATE, STATE))
        mean[:, (0, 2)], mean[:, 1] = self.places_m[chosen], self.floor_m
        tall = np.maximum(self.heads_m[chosen], 0.5 * STATURE_M)
        tall_m2 = np.square(self.deviations_m[chosen, 2] / tall)
        gain = config.build**2 / (config.build**2 + tall_m2)
        mean[:, 6] = gain * np.log(tall / STATURE_M)
        turn = self._axes(chosen)
        noise = np.square(self.deviations_m[chosen, :2])[:, :, None] * np.eye(2)
        covariance[:, (0, 0, 2, 2), (0, 2, 0, 2)] = (turn.transpose(0, 2, 1) @ noise @ turn).reshape(-1, 4)
        covariance[:, 1, 1] = config.floor_m**2
        covariance[:, 3:6, 3:6] = np.diag(np.square(config.speed_m_s))
        covariance[:, 6, 6] = (1.0 - gain) * config.build**2
        return StateEstimates(mean, covariance)

    def _axes(self, chosen: NDArray[np.intp]) -> Floats:
        """Return the directions (K, 2, 2) across and along the lines of sight."""
        away = self.places_m[chosen] - self.seen_from_m
        sight = away / np.maximum(np.hypot(*away.T), 1e-6)[:, None]
        across = np.stack([sight[:, 1], -sight[:, 0]], axis=1)
        return np.stack([across, sight], axis=1)

    def _values(self, chosen: NDArray[np.intp]) -> Floats:
        """Return the measured values (K, 3): across and along the lines of sight, and depth of the head."""
        along = (self._axes(chosen) @ self.places_m[chosen][:, :, None])[:, :, 0]
        return np.column_stack([along, self.floor_m - self.heads_m[chosen]])

    def _linearise(self, states: StateEstimates, chosen: NDArray[np.intp]) -> Linearised:
        axes = self._axes(chosen)
        slope = np.zeros((len(states), 3, STATE))
        slope[:, :2, (0, 2)] = axes
        stature = STATURE_M * np.exp(states.mean[:, 6])
        slope[:, 2, 1], slope[:, 2, 6] = 1.0, -stature
        along = (axes @ states.mean[:, (0, 2)][:, :, None])[:, :, 0]
        return Linearised(np.column_stack([along, states.mean[:, 1] - stature]), slope)


def _ends(boxes: Floats) -> Floats:
    """Return the middle column and the rows of head and feet (M, 3) of boxes (M, 4)."""
    left, top, width, height = boxes.T
    return np.stack([left + width / 2.0, top, top + height], axis=1)
