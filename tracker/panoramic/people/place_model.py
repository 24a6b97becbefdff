"""What was learned of people in patches: whether somebody is there, where exactly, and how sure that is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.panoramic.people.figure_patch import PATCH, Map

INPUTS = PATCH + 2
_FARTHEST_M = 8.0


@dataclass(frozen=True, slots=True, eq=False)
class Network:
    """A small network: layers of sums, cut off below 0 between them.

    Attributes:
        layers: (inputs, units) weights and (units,) bias of each layer.
    """

    layers: Sequence[tuple[Map, Map]]

    def tell(self, inputs: Map) -> Map:
        """Give the outputs (N, outputs) for inputs (N, inputs)."""
        *hidden, (weights, bias) = self.layers
        for inner, inner_bias in hidden:
            inputs = inputs @ inner
            inputs += inner_bias
            np.maximum(inputs, np.float32(0), out=inputs)
        return inputs @ weights + bias


@dataclass(frozen=True, slots=True, eq=False)
class Sightings:
    """What is seen at N places.

    Attributes:
        evidence: (N,) log odds that a person is within reach of the place.
        offset_m: (N, 2) where that person is from there: farther away, and to the left [m].
        deviation_m: (N, 2) standard deviations of these [m].
    """

    evidence: Map
    offset_m: Map
    deviation_m: Map


@dataclass(frozen=True, slots=True, eq=False)
class PlaceModel:
    """Networks that read patches.

    Attributes:
        presence: to the log odds that somebody is there.
        place: to the offset of the person [m].
        doubt: to the logarithms of the offset's standard deviations [m].
    """

    presence: Network
    place: Network
    doubt: Network

    def look(self, patches: Map, distance_m: NDArray[np.float64]) -> Sightings:
        """Tell what patches (N, PATCH) at distances (N,) show."""
        inputs = with_distance(patches, distance_m)
        return Sightings(
            evidence=self.presence.tell(inputs)[:, 0],
            offset_m=self.place.tell(inputs),
            deviation_m=np.exp(self.doubt.tell(inputs)),
        )


def with_distance(patches: Map, distance_m: NDArray[np.float64]) -> Map:
    """Append distances (N,), in two forms, to patches (N, PATCH): inputs (N, INPUTS) of the networks."""
    inputs = np.empty((len(patches), INPUTS), np.float32)
    inputs[:, :PATCH] = patches
    inputs[:, PATCH] = 1.0 / distance_m
    inputs[:, PATCH + 1] = np.minimum(distance_m, _FARTHEST_M) / _FARTHEST_M
    return inputs
