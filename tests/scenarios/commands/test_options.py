"""Numbers on the command line are taken within their limits, and else refused with what would be right."""

from __future__ import annotations

import click
import pytest

from peopleboy.scenarios.commands.command_options import Number, WholeNumber


@pytest.mark.parametrize(
    ("kind", "text", "told"),
    [
        (WholeNumber(min=0), "x", "must be a whole number of at least 0, got x"),
        (WholeNumber(min=0), "1.5", "must be a whole number of at least 0, got 1.5"),
        (WholeNumber(min=1), "-3", "must be a whole number of at least 1, got -3"),
        (WholeNumber(1, 65534), "70000", "must be a whole number from 1 to 65534, got 70000"),
        (Number(0.0, 1.0, max_open=True), "1", "must be a number from 0 to less than 1, got 1"),
        (Number(min=5.0), "4.9", "must be a number of at least 5, got 4.9"),
        (Number(min=5.0), "nan", "must be a number of at least 5, got nan"),
        (Number(min=5.0), "inf", "must be a number of at least 5, got inf"),
    ],
)
def test_what_is_none_within_the_limits_is_refused(kind: WholeNumber | Number, text: str, told: str) -> None:
    with pytest.raises(click.BadParameter) as caught:
        kind.convert(text, None, None)
    assert caught.value.message == told


def test_what_is_within_them_is_taken() -> None:
    assert WholeNumber(1, 5).convert("5", None, None) == 5
    assert Number(0.0, 1.0, max_open=True).convert("0.25", None, None) == 0.25
