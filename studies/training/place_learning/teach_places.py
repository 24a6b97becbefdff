"""Teaching the networks that read patches."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.studies.training.place_learning.place_examples import PlaceExamples
from peopleboy.tracker.panoramic.people.figure_patch import Map
from peopleboy.tracker.panoramic.people.place_model import Network, PlaceModel

if TYPE_CHECKING:
    from sklearn.neural_network import MLPClassifier, MLPRegressor

PLACE_UNITS: Final = (96, 32)
PRESENCE_UNITS: Final = (24,)
DOUBT_UNITS: Final = (24,)
EPOCHS: Final = {"place": 24, "presence": 10, "doubt": 8}
_LEAST_ERROR_M: Final = 1e-3
_LOG_OF_NORMAL: Final = 0.6352
"""Minus the mean of log |e| for a normal e of deviation 1."""


def teach_places(examples: PlaceExamples, *, seed: int = 0) -> PlaceModel:
    """Teach where people are, how sure that is, and whether they are there.

    How sure it is is learned from errors on the half of the examples that a network did not see.

    Args:
        examples: in the order in which they were collected, so that halves have other scenes.
        seed: draws first weights and order.

    Raises:
        BadInput: scikit-learn is missing.
    """
    inputs, is_person = examples.inputs, examples.is_person
    people, offset = inputs[is_person], examples.offset_m[is_person]
    place = _fit(_regressor("place", PLACE_UNITS, seed), people, offset)
    errors = np.abs(_cross_errors(people, offset, seed))
    doubt = _fit(
        _regressor("doubt", DOUBT_UNITS, seed), people, np.log(errors + _LEAST_ERROR_M) + _LOG_OF_NORMAL
    )
    presence = _fit(_classifier(seed), inputs, is_person)
    return PlaceModel(presence=_network(presence), place=_network(place), doubt=_network(doubt))


def _cross_errors(people: Map, offset: NDArray[np.float64], seed: int) -> NDArray[np.float64]:
    """Give the errors (N, 2) of a network that was taught with the other half."""
    half = len(people) // 2
    errors = np.empty_like(offset)
    for own, other in ((slice(half), slice(half, None)), (slice(half, None), slice(half))):
        taught = _fit(_regressor("place", PLACE_UNITS, seed), people[other], offset[other])
        errors[own] = taught.predict(people[own]) - offset[own]
    return errors


def _regressor(name: str, units: tuple[int, ...], seed: int) -> MLPRegressor:
    return _neural_network().MLPRegressor(
        hidden_layer_sizes=units,
        alpha=1e-2,
        batch_size=200,
        learning_rate_init=2e-3,
        max_iter=EPOCHS[name],
        random_state=seed,
    )


def _classifier(seed: int) -> MLPClassifier:
    return _neural_network().MLPClassifier(
        hidden_layer_sizes=PRESENCE_UNITS,
        alpha=1e-3,
        batch_size=200,
        max_iter=EPOCHS["presence"],
        random_state=seed,
    )


def _neural_network() -> Any:
    try:
        from sklearn import neural_network
    except ImportError:
        raise BadInput("train-places needs scikit-learn: pip install scikit-learn") from None
    return neural_network


def _fit(network: Any, inputs: Map, told: NDArray[Any]) -> Any:
    """Let a network learn, and again for a quarter of the epochs in steps of a tenth of the size."""
    rate, epochs = network.learning_rate_init, network.max_iter
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # it is meant to end after so many epochs
        network.set_params(warm_start=True).fit(inputs, told)
        finer = network.set_params(learning_rate_init=rate / 10.0, max_iter=max(epochs // 4, 1))
        return finer.fit(inputs, told)


def _network(taught: Any) -> Network:
    layers = zip(taught.coefs_, taught.intercepts_, strict=True)
    return Network([(weights.astype(np.float32), bias.astype(np.float32)) for weights, bias in layers])
