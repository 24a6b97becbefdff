"""Clothes by whose colours people can be told apart."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from peopleboy.scenarios.files.schema.people import ClothesSpec, PersonSpec

# Colours that differ clearly from each other in hue or brightness; a white top stays apart from yellow ones.
TOP_COLOURS = ("white", "black", "red", "yellow", "green", "blue", "pink", "orange")
BOTTOM_COLOURS = ("black", "khaki", "blue", "white", "red", "green", "light_grey", "purple")


def tell_apart(people: Sequence[PersonSpec], rng: np.random.Generator) -> tuple[PersonSpec, ...]:
    """Give everybody a top and a bottom of colours that nobody else wears, as far as there are colours.

    Colours that a person has already stay, and are not avoided by others. With more than eight people the
    colours begin again.
    """
    tops, bottoms = rng.permutation(TOP_COLOURS), rng.permutation(BOTTOM_COLOURS)
    return tuple(
        _dress(person, str(tops[index % len(tops)]), str(bottoms[index % len(bottoms)]))
        for index, person in enumerate(people)
    )


def _dress(person: PersonSpec, top: str, bottom: str) -> PersonSpec:
    given = {} if person.clothes is None else person.clothes.model_dump(exclude_none=True)
    clothes = ClothesSpec.model_validate({"top_colour": top, "bottom_colour": bottom} | given)
    return person.model_copy(update={"clothes": clothes})
