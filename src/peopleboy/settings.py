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

import math
import operator
from collections.abc import Iterator, Mapping
from dataclasses import MISSING, dataclass, fields, is_dataclass, replace
from dataclasses import Field as DataclassField
from enum import Enum
from functools import cache
from types import NoneType, UnionType
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    Final,
    Literal,
    TypeVar,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

from pydantic import Field
from pydantic.fields import FieldInfo

from peopleboy.bad_input import BadInput, found_in

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

C = TypeVar("C", bound="DataclassInstance")

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


Coordinate = Annotated[float, Field(ge=-1000.0, le=1000.0)]
Point = Annotated[tuple[Coordinate, Coordinate], Field(strict=False)]
Position = Annotated[tuple[Coordinate, Coordinate, Coordinate], Field(strict=False)]
Seconds = Annotated[float, Field(ge=0.0, le=36000.0)]
Degrees = Annotated[float, Field(ge=-720.0, le=720.0)]
Celsius = Annotated[float, Field(ge=-40.0, le=400.0)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Extent = Annotated[float, Field(ge=0.005, le=100.0)]
Size = Annotated[tuple[Extent, Extent, Extent], Field(strict=False)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_-]{0,39}$")]
Word = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,59}$")]


def word_or_list(value: Any) -> str:
    """Tell apart the two forms of a setting that takes a word or a list of numbers, for pydantic's unions."""
    return "word" if isinstance(value, str) else "list"


class _InDegrees:
    """Marks an angle that code keeps in radians (`pitch_rad`) and that is set in degrees (`pitch_deg`)."""


@dataclass(frozen=True, slots=True)
class ByName:
    """Marks a field that holds settings itself: its key takes one of these names, or keys of its own."""

    known: Mapping[str, Any]


class _Positional:
    """Marks a setting that commands take as an argument, not as an option."""


@dataclass(frozen=True, slots=True)
class Metavar:
    """What stands for the value of an option in a command's help."""

    text: str


POSITIONAL: Final = _Positional()
"""Metadata of a setting that a command takes as an argument, such as the scenario."""

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
    def is_positional(self) -> bool:
        """Whether commands take it as an argument."""
        return POSITIONAL in self.metadata

    def from_key(self, value: Any) -> Any:
        """Convert a value of the key to one of the field.

        Raises:
            BadInput: the field holds settings itself, and they cannot be so.
        """
        if is_dataclass(self.kind):
            known = next(entry.known for entry in self.metadata if isinstance(entry, ByName))
            with found_in(self.key):
                return known[value] if isinstance(value, str) else with_keys(self.default, value)
        return math.radians(value) if self.is_in_degrees else value

    def to_key(self, value: Any) -> Any:
        """Convert a value of the field to one of the key."""
        # Degrees that were given as a round number are round again.
        return round(math.degrees(value), 10) if self.is_in_degrees else value

    @property
    def metavar(self) -> str | None:
        """What stands for the value in a command's help; None for the usual."""
        return next((entry.text for entry in self.metadata if isinstance(entry, Metavar)), None)

    @property
    def is_required(self) -> bool:
        """Whether it has no default."""
        return self.default is MISSING


def unit_of(key: str) -> str:
    """Return the unit of a setting by how its name ends; empty if it has none."""
    return next((unit for end, unit in UNITS.items() if key.endswith(end)), "")


def settings_of(config: Any) -> tuple[Setting, ...]:
    """List the settings of a dataclass, a class, in the order of its fields."""
    return _settings_of(config)


@cache
def _settings_of(config: Any) -> tuple[Setting, ...]:
    hints = get_type_hints(config, include_extras=True)
    return tuple(_setting(field, hints[field.name]) for field in fields(config) if field.init)


def meaning_of(config: type[Any], field: str) -> FieldInfo:
    """Return limits and meaning of a field, for another class that has the same setting."""
    hint = get_type_hints(config, include_extras=True)[field]
    about = (entry for entry in _unwrapped(hint)[1] if isinstance(entry, FieldInfo))
    return next(entry for entry in about if entry.description)


def with_keys(config: C, given: Mapping[str, Any]) -> C:
    """Return settings with those values changed whose keys are given; other keys are passed over.

    Raises:
        BadInput: the settings refuse them.
    """
    own = settings_of(type(config))
    return replace(config, **{one.field: one.from_key(given[one.key]) for one in own if one.key in given})


def check_limits(settings: Any) -> None:
    """Refuse values beyond the limits of their settings, and words that are not among the choices.

    Args:
        settings: an instance of a dataclass.

    Raises:
        BadInput: with the key of the first that is wrong.
    """
    for setting in settings_of(type(settings)):
        value = getattr(settings, setting.field)
        if value is not None or not setting.can_be_none:
            _check(setting, value)


def _setting(field: DataclassField[Any], hint: Any) -> Setting:
    kind, metadata = _unwrapped(hint)
    about = [entry for entry in metadata if isinstance(entry, FieldInfo)]
    alias = next((entry.alias for entry in about if entry.alias), None)
    bare, can_be_none = _without_none(kind)
    bare, inner = _unwrapped(bare)
    is_in_degrees = IN_DEGREES in metadata
    key = alias or (field.name.replace("_rad", "_deg") if is_in_degrees else field.name)
    default = field.default if field.default_factory is MISSING else field.default_factory()
    setting = Setting(
        field=field.name,
        key=key,
        unit=unit_of(key),
        kind=bare,
        can_be_none=can_be_none,
        choices=_choices(bare),
        limits=dict(_limits((*metadata, *inner))),
        default=default,
        meaning=next((entry.description for entry in about if entry.description), ""),
        metadata=(*metadata, *inner),
    )
    return setting if default is MISSING else replace(setting, default=setting.to_key(default))


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
