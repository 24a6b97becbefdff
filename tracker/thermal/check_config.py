"""Refusals of settings that cannot be."""

from __future__ import annotations

from peopleboy.bad_input import BadInput


def check_positive(config: object, *names: str) -> None:
    """Refuse a record in which one of the named numbers is not positive."""
    for name in names:
        refuse_unless(getattr(config, name) > 0, config, name, "positive")


def check_share(config: object, *names: str) -> None:
    """Refuse a record in which one of the named numbers is not in 0..1."""
    for name in names:
        refuse_unless(0 <= getattr(config, name) <= 1, config, name, "in 0..1")


def check_not_negative(config: object, *names: str) -> None:
    """Refuse a record in which one of the named numbers is negative."""
    for name in names:
        refuse_unless(getattr(config, name) >= 0, config, name, "0 or more")


def refuse_unless(is_right: bool, config: object, name: str, rule: str) -> None:
    """Refuse a record in which the named value breaks a rule."""
    if not is_right:
        raise BadInput(f"{type(config).__name__}: {name} must be {rule}, got {getattr(config, name)}")
