"""The learned model of people in patches as a file."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Final

from peopleboy.bad_input import BadInput
from peopleboy.tracker.panoramic.panorama_view import PanoramaView
from peopleboy.tracker.panoramic.people.place_model import INPUTS, Network, PlaceModel
from peopleboy.tracker.panoramic.weights_file import Weights

SHIPPED: Final = Path(__file__).parent / "networks" / "places.npz"
"""The model that comes with the tracker."""

COMMAND: Final = "peopleboy train-places"
OUTPUTS: Final = {"presence": 1, "place": 2, "doubt": 2}
"""How many numbers each network tells."""


def save_places(path: Path, model: PlaceModel, view: PanoramaView, about: Mapping[str, str]) -> None:
    """Write a model that holds for the camera of this view."""
    Weights(
        {
            f"{name}.{number}.{part}": array
            for name in OUTPUTS
            for number, layer in enumerate(_network(model, name).layers)
            for part, array in zip(("weights", "bias"), layer, strict=True)
        },
        view,
        about,
    ).save(path)


def load_places(path: Path = SHIPPED) -> tuple[PlaceModel, PanoramaView]:
    """Read and check a model, and tell for which camera it holds.

    Raises:
        BadInput: a file that is missing or is no such model.
    """
    weights = Weights.load(path, COMMAND)
    networks = {name: _read(weights, name, path) for name in OUTPUTS}
    return PlaceModel(**networks), weights.view


def _network(model: PlaceModel, name: str) -> Network:
    return {"presence": model.presence, "place": model.place, "doubt": model.doubt}[name]


def _read(weights: Weights, name: str, path: Path) -> Network:
    arrays = weights.arrays
    count = sum(key.startswith(f"{name}.") and key.endswith(".weights") for key in arrays)
    try:
        layers = [(arrays[f"{name}.{k}.weights"], arrays[f"{name}.{k}.bias"]) for k in range(count)]
    except KeyError as error:
        raise BadInput(f"{error} is missing; `{COMMAND}` makes such a file", file=str(path)) from None
    shapes = [matrix.shape for matrix, _ in layers]
    widths = [INPUTS, *(bias.size for _, bias in layers)]
    if shapes != list(pairwise(widths)) or widths[-1] != OUTPUTS[name]:
        raise BadInput(f"{name}: layers do not fit: {shapes}; `{COMMAND}` makes such a file", file=str(path))
    return Network(layers)
