"""Settings: fields of a dataclass that carry their unit, limits, default and meaning.

A setting is declared once, and everything else is derived from it: the keys of scenario files and their JSON
schema, options of commands, pages of the reference, and the check of what Python code passes.

    @dataclass(frozen=True, slots=True, kw_only=True)
    class ThermalConfig:
        netd_k: Annotated[float, Field(ge=0.0, le=5.0, description="noise, new in every image")] = 0.08

The name's last letters are the unit (`unit_of`), `Field` is pydantic's, with the limits and the meaning, and
the dataclass stays a plain one. `settings_of` lists the settings of a class with all of that. `check_limits`
refuses values beyond the limits, for a `__post_init__`. An angle may be kept in radians and set in degrees:
mark it with `IN_DEGREES`.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import MISSING, Field, dataclass, fields
from enum import Enum
from functools import cache
from types import NoneType, UnionType
from typing import Annotated, Any, Final, Literal, Union, get_args, get_origin, get_type_hints

from pydantic.fields import FieldInfo

from peopleboy.bad_input import BadInput

UNITS: Final[Mapping[str, str]] = {
    "_deg_s": "deg/s",
    "_k_per_min": "K/min",
    "_percent": "%",
    "_m_s": "m/s",
    "_deg": "deg",
    "_px": "px",
    "_hz": "Hz",
    "_m": "m",
    "_s": "s",
    "_c": "°C",
    "_k": "K",
}
"""Units by how the name of a setting ends, the longer endings first."""


_KEEPS: Final = {"ge": operator.ge, "gt": operator.gt, "le": operator.le, "lt": operator.lt}
_WORDS: Final = {"ge": "at least", "gt": "greater than", "le": "at most", "lt": "less than"}


class _InDegrees:
    """Marks an angle that code keeps in radians (`pitch_rad`) and that is set in degrees (`pitch_deg`)."""


IN_DEGREES: Final = _InDegrees()
"""Metadata of a field that ends in `_rad`: its key ends in `_deg`, and its limits are in degrees."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """One setting of a class.

    Attributes:
        field: name of the dataclass field.
        key: name in files and options; that of the field unless its metadata say otherwise.
        unit: by the key's ending; empty without one.
        kind: its type, without None.
        can_be_none: whether None is a value, too.
        choices: the values that there are; empty if there are no words to choose from.
        limits: on a number, in the unit of the key: by `ge`, `gt`, `le` and `lt`, as pydantic names them.
        default: in the unit of the key; `dataclasses.MISSING` if the setting must be given.
        meaning: what it is for.
        metadata: all that its annotation carries besides the type.
    """

    field: str
    key: str
    unit: str
    kind: Any
    can_be_none: bool
    choices: tuple[Any, ...]
    limits: Mapping[str, float]
    default: Any
    meaning: str
    metadata: tuple[Any, ...]

    @property
    def is_in_degrees(self) -> bool:
        """Whether the key is in degrees and the field in radians."""
        return IN_DEGREES in self.metadata

    @property
    def is_required(self) -> bool:
        """Whether it has no default."""
        return self.default is MISSING


def unit_of(key: str) -> str:
    """Return the unit of a setting by how its name ends; empty if it has none."""
    return next((unit for end, unit in UNITS.items() if key.endswith(end)), "")


@cache
def settings_of(config: Hashable) -> tuple[Setting, ...]:
    """List the settings of a dataclass, a class, in the order of its fields."""
    assert isinstance(config, type)
    hints = get_type_hints(config, include_extras=True)
    return tuple(_setting(field, hints[field.name]) for field in fields(config) if field.init)


def check_limits(settings: Any) -> None:
    """Refuse values beyond the limits of their settings, and words that are not among the choices.

    Args:
        settings: an instance of a dataclass.

    Raises:
        BadInput: with the key of the first that is wrong.
    """
    for setting in settings_of(type(settings)):  # type: ignore[arg-type]
        value = getattr(settings, setting.field)
        if value is not None or not setting.can_be_none:
            _check(setting, value)


def _setting(field: Field[Any], hint: Any) -> Setting:
    kind, metadata = _unwrapped(hint)
    about = next((entry for entry in metadata if isinstance(entry, FieldInfo)), FieldInfo())
    bare, can_be_none = _without_none(kind)
    bare, inner = _unwrapped(bare)
    is_in_degrees = IN_DEGREES in metadata
    key = about.alias or (field.name.replace("_rad", "_deg") if is_in_degrees else field.name)
    default = field.default if field.default_factory is MISSING else field.default_factory()
    return Setting(
        field=field.name,
        key=key,
        unit=unit_of(key),
        kind=bare,
        can_be_none=can_be_none,
        choices=_choices(bare),
        limits=dict(_limits((*metadata, *inner))),
        # Degrees that were given as a round number are round again.
        default=round(math.degrees(default), 10) if is_in_degrees and default is not MISSING else default,
        meaning=about.description or "",
        metadata=metadata,
    )


def _unwrapped(hint: Any) -> tuple[Any, tuple[Any, ...]]:
    if get_origin(hint) is Annotated:
        kind, *metadata = get_args(hint)
        return kind, tuple(metadata)
    return hint, ()


def _without_none(kind: Any) -> tuple[Any, bool]:
    if get_origin(kind) not in (Union, UnionType):
        return kind, False
    others = tuple(option for option in get_args(kind) if option is not NoneType)
    return (others[0] if len(others) == 1 else Union[others]), len(others) < len(get_args(kind))  # noqa: UP007


def _choices(kind: Any) -> tuple[Any, ...]:
    if get_origin(kind) is Literal:
        return get_args(kind)
    return tuple(kind) if isinstance(kind, type) and issubclass(kind, Enum) else ()


def _limits(metadata: tuple[Any, ...]) -> Iterator[tuple[str, float]]:
    for entry in metadata:
        for limit in entry.metadata if isinstance(entry, FieldInfo) else (entry,):
            yield from ((name, getattr(limit, name)) for name in _WORDS if hasattr(limit, name))


def _check(setting: Setting, value: Any) -> None:
    if setting.choices and value not in setting.choices:
        known = ", ".join(map(str, setting.choices))
        raise BadInput(f"unknown {setting.key} {value!r}; choose from {known}", key=(setting.key,))
    for name, bound in setting.limits.items():
        # The bound is converted, not the value: one that was converted from degrees then equals the bound.
        here = math.radians(bound) if setting.is_in_degrees else bound
        if not _KEEPS[name](value, here):  # as NaN does not
            shown = math.degrees(value) if setting.is_in_degrees else value
            raise BadInput(f"must be {_WORDS[name]} {bound:g}, got {shown!r}", key=(setting.key,))
