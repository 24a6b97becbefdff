"""What a refusal has to name, whatever its words are."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from peopleboy.bad_input import BadInput


@contextmanager
def refused(*named: object) -> Iterator[None]:
    """Expect bad input to be refused in one line that names all of these, such as file, key and value."""
    with pytest.raises(BadInput) as caught:
        yield
    assert_names(str(caught.value), *named)


def assert_names(told: str, *named: object) -> None:
    """Check that a message is one line that names all of these."""
    assert "\n" not in told.removesuffix("\n"), told
    assert not [each for each in map(str, named) if each not in told], told
