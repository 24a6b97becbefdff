"""Make settings from the plain data of a file, and explain errors in one line."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import is_dataclass, replace
from functools import cache
from typing import Annotated, Any, Final, Literal, TypeVar, Union, cast, get_args, get_origin

from pydantic import (
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    GetCoreSchemaHandler,
    Tag,
    TypeAdapter,
    ValidationError,
    create_model,
)
from pydantic_core import CoreSchema, SchemaValidator, core_schema

from peopleboy.bad_input import BadInput, Key
from peopleboy.settings import ByName, Setting, settings_of, word_or_list
from peopleboy.sim.cameras.kinds import KINDS, CameraKind
from peopleboy.wording import hint

M = TypeVar("M")

_MOST_FAULTS = 3
_MOST_EXPLAINED = 100  # of which equal ones are listed once
_UNKNOWN_KEY = ("extra_forbidden", "unexpected_keyword_argument")
_TAGS = ("word", "list")  # tags of the unions that the settings declare

_LIMITS = {
    "greater_than": "must be greater than {gt:g}",
    "greater_than_equal": "must be at least {ge:g}",
    "less_than": "must be less than {lt:g}",
    "less_than_equal": "must be at most {le:g}",
    "finite_number": "must be a finite number",
    "float_type": "must be a number",
    "int_type": "must be a whole number",
    "bool_type": "must be true or false",
    "string_type": "must be text",
    "tuple_type": "must be a list",
    "dict_type": "must be a mapping of keys to values",
    "dataclass_type": "must be a mapping of keys to values",
    "model_type": "must be a mapping of keys to values",
    "model_attributes_type": "must be a mapping of keys to values",
    "string_too_short": "must not be empty",
    "string_too_long": "must have at most {max_length} letters",
    "too_short": "must have at least {min_length} entries",
    "too_long": "must have at most {max_length} entries",
}

STRICT: Final = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)
"""Configuration that refuses unknown keys, numbers written as text, NaN and infinity."""


class Strict(BaseModel):
    """A strict model for data that are not settings of the simulator."""

    model_config = STRICT


class Given:
    """Mark a mapping that holds only those keys of a settings class that the file gives."""

    def __init__(self, config: type[Any], what: str, *, shows_defaults: bool) -> None:
        settings = settings_of(config)
        self.models = (_keys_model(config.__name__, what, settings, shows_defaults=shows_defaults),)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Validate a mapping with the model, and keep only the given keys."""
        del source
        return _kept(handler.generate_schema(self.models[0]))


class GivenCamera:
    """Mark a mapping that holds only the given keys of a camera: `kind`, and keys of that kind."""

    @property
    def models(self) -> tuple[type[BaseModel], ...]:
        """One model for each registered kind of camera."""
        return tuple(_camera_model(name, kind) for name, kind in KINDS.items())

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Validate a mapping with the model of its kind, and keep only the given keys."""
        del source
        kinds: Any = Union[self.models]  # noqa: UP007
        return _kept(handler.generate_schema(Annotated[kinds, Field(discriminator="kind")]))


def _kept(schema: CoreSchema) -> CoreSchema:
    return core_schema.no_info_after_validator_function(
        lambda model: model.model_dump(exclude_none=True),
        schema,
        serialization=core_schema.simple_ser_schema("any"),
    )


@cache
def _camera_model(name: str, kind: CameraKind) -> type[BaseModel]:
    about = (kind.config.__doc__ or "").partition("\n")[0]
    own = settings_of(kind.config)
    camera = kind.config().camera
    # The default geometry of a kind may differ from the defaults of its geometry class.
    geometry = [
        replace(one, default=one.to_key(getattr(camera, one.field))) for one in settings_of(type(camera))
    ]
    settings = (*geometry, *own)
    extra: dict[str, Any] = {"kind": (Literal[name], Field(description=f"kind of camera: {kind.what}"))}
    if kind.presets:
        meaning = f"preset for omitted keys: {kind.presets_are}"
        extra["preset"] = (Literal[*kind.presets] | None, Field(default=None, description=meaning))
    return _keys_model(f"{name.capitalize()}Camera", about, settings, shows_defaults=True, extra=extra)


def _keys_model(
    name: str,
    what: str,
    settings: Sequence[Setting],
    *,
    shows_defaults: bool,
    extra: Mapping[str, Any] | None = None,
) -> type[BaseModel]:
    """Make a model of the keys of some settings; every key is optional."""
    fields = {
        setting.key: (
            _type_of(setting) | None,
            Field(
                default=None,
                description=setting.meaning,
                json_schema_extra={"default": _plain(setting)} if shows_defaults else None,
            ),
        )
        for setting in settings
        if setting.meaning
    }
    return create_model(name, __base__=Strict, __doc__=what, **(dict(extra or {}) | fields))


def _type_of(setting: Setting) -> Any:
    kind = setting.kind
    if not is_dataclass(kind):
        limits = [part for entry in setting.metadata for part in getattr(entry, "metadata", ())]
        return Annotated[kind, *limits] if limits else kind
    known = next(entry.known for entry in setting.metadata if isinstance(entry, ByName))
    own = Given(setting.kind, (kind.__doc__ or "").partition("\n")[0], shows_defaults=True)
    return Annotated[
        Annotated[Literal[*known], Tag("word")] | Annotated[dict[str, Any], own, Tag("list")],
        Discriminator(word_or_list),
    ]


def _plain(setting: Setting) -> Any:
    """Return a default as plain JSON data; None if it has no plain form."""
    default = setting.default
    if isinstance(default, float):
        return round(default, 4)
    if isinstance(default, tuple):
        return list(default)
    return default if isinstance(default, bool | int | str) else None


def validated(kind: type[M], data: object) -> M:
    """Make settings from plain data.

    Args:
        kind: a dataclass with settings, or a model.
        data: contents of a file, or settings that are already validated.

    Raises:
        BadInput: the data are invalid; the message locates up to three faults, misspelt keys first.
    """
    try:
        # Kinds of cameras can be registered or replaced at run time, so they are part of the cache key.
        settings: M = _validator(cast(Any, kind), tuple(KINDS.items())).validate_python(data)
    except ValidationError as error:
        raise _explain(error, kind) from error
    return settings


@cache
def _validator(kind: Any, cameras: tuple[tuple[str, CameraKind], ...]) -> SchemaValidator:
    del cameras
    return SchemaValidator(_takes_mappings(TypeAdapter(kind, config=config_of(kind)).core_schema))


def config_of(kind: Any) -> ConfigDict | None:
    """Return the configuration for a `TypeAdapter`; None for classes, which have their own."""
    is_class = isinstance(kind, type) and (is_dataclass(kind) or issubclass(kind, BaseModel))
    return None if is_class else STRICT


def _takes_mappings(schema: Any) -> Any:
    """Allow dataclasses to be made from mappings, which strict mode refuses; their values stay strict."""
    if isinstance(schema, dict):
        inner = {key: value if key == "metadata" else _takes_mappings(value) for key, value in schema.items()}
        return inner | {"strict": False} if schema.get("type") == "dataclass" else inner
    return type(schema)(map(_takes_mappings, schema)) if isinstance(schema, list | tuple) else schema


def _explain(error: ValidationError, model: Any) -> BadInput:
    every = error.errors(include_url=False)
    # A list that has an invalid entry also seems too short.
    above = {fault["loc"][:end] for fault in every for end in range(len(fault["loc"]))}
    faults = [fault for fault in every if fault["loc"] not in above]
    faults.sort(key=lambda fault: fault["type"] not in _UNKNOWN_KEY)
    found = [_explain_one(fault, model) for fault in faults[:_MOST_EXPLAINED]]
    lines = list(dict.fromkeys(map(str, found)))
    if len(lines) == 1:
        return found[0]
    rest = len(lines) - _MOST_FAULTS + len(faults[_MOST_EXPLAINED:])
    more = f"; and {rest} more" if rest > 0 else ""
    return BadInput("; ".join(lines[:_MOST_FAULTS]) + more)


def _explain_one(fault: Any, model: Any) -> BadInput:
    steps, owner, kinds, words = _follow(fault["loc"], model)
    kind, context = fault["type"], fault.get("ctx", {})
    if kind == "union_tag_not_found":
        return BadInput(f"missing key 'kind'; choose from {', '.join(kinds)}", key=steps)
    if kind == "missing" and isinstance(steps[-1], str):
        choice = f"; choose from {', '.join(words)}" if words else ""
        return BadInput(f"missing key {steps[-1]!r}{choice}", key=steps[:-1])
    if kind in _UNKNOWN_KEY:
        return BadInput(f"unknown key {_shown(steps[-1])}; {hint(str(steps[-1]), owner)}", key=steps[:-1])
    if kind == "value_error" and isinstance(context["error"], BadInput):
        return context["error"].within(*steps)
    if steps and steps[-1] == "[key]":  # pydantic appends it if a key itself is invalid
        steps = steps[:-1]
    label = next((step for step in reversed(steps) if isinstance(step, str)), "value")
    if "colours" in steps:
        label = "colour"
    return BadInput(_what(kind, context, fault, label), key=steps)


def _what(kind: str, context: Any, fault: Any, label: str) -> str:
    value = _shown(fault["input"])
    if kind == "tuple_type" and fault["loc"][-1] == "list":
        return f"must be a word or a list of numbers, got {value}"
    if kind in ("literal_error", "union_tag_invalid"):
        known = re.findall(r"'([^']*)'", context.get("expected") or context["expected_tags"])
        word = context.get("tag", fault["input"])
        what = context.get("discriminator", label).strip("'")
        return f"unknown {what} {_shown(word)}; {hint(str(word), known)}"
    if kind == "string_pattern_mismatch" and label in ("tracker", "behaviour") and ":" in fault["input"]:
        return f"{value} is your own class, which a file cannot name; give --{label} {value[1:-1]} instead"
    if kind == "string_pattern_mismatch":
        return f"{value} is not a name: use letters, digits, _ and start with a letter"
    if kind == "missing":
        return "missing value"
    if kind == "value_error":
        return str(context["error"])
    if kind in _LIMITS:
        return f"{_LIMITS[kind].format(**context)}, got {value}"
    return f"{fault['msg'][:1].lower()}{fault['msg'][1:]}, got {value}"


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 40 else f"{text[:37]}..."


def _follow(loc: Sequence[str | int], model: Any) -> tuple[Key, list[str], list[str], list[str]]:
    """Drop pydantic's union tags from a path, and list the keys, kinds and words valid at its end."""
    steps: list[str | int] = []
    known: list[str] = []
    types: list[Any] = list(_inside(model))
    is_key = False
    for step in loc:
        models = [candidate for candidate in types if _keys(candidate)]
        tagged = [candidate for candidate in models if _tag(candidate) == step]
        if not is_key and (step in _TAGS or (tagged and len(models) > 1)):
            types = tagged
            continue
        steps.append(step)
        if not is_key and isinstance(step, str) and models:
            known = [key for candidate in models for key in _keys(candidate)]
            fields = [_keys(candidate)[step] for candidate in models if step in _keys(candidate)]
            types = [inner for annotation in fields for inner in _inside(annotation)] if fields else types
            # In a mapping the next step is a key, even if it equals a tag; the step after it is in the value.
            is_key = any(_is_mapping(annotation) for annotation in fields)
        else:
            is_key = False
    kinds = sorted({tag for candidate in types if (tag := _tag(candidate))})
    return tuple(steps), known, kinds, sorted(str(word) for word in types if isinstance(word, str))


def _keys(candidate: Any) -> Mapping[str, Any]:
    """Return the types of the keys of settings or of a model, by key; empty for anything else."""
    if not isinstance(candidate, type):
        return {}
    if is_dataclass(candidate):
        return {one.key: Annotated[one.kind, *one.metadata, None] for one in settings_of(candidate)}
    if issubclass(candidate, BaseModel):
        return {field.alias or name: field.annotation for name, field in candidate.model_fields.items()}
    return {}


def _is_mapping(annotation: Any) -> bool:
    """Return whether a value is a mapping with arbitrary keys."""
    kind = get_args(annotation)[0] if get_origin(annotation) is Annotated else annotation
    return get_origin(kind) is dict and not _given(annotation)


def _tag(candidate: Any) -> str:
    kinds = [word for word in _inside(_keys(candidate).get("kind")) if isinstance(word, str)]
    return str(kinds[0]) if kinds else ""


def _given(annotation: Any) -> tuple[type[BaseModel], ...]:
    marks = getattr(annotation, "__metadata__", ())
    return next((mark.models for mark in marks if isinstance(mark, Given | GivenCamera)), ())


def _inside(annotation: Any) -> list[Any]:
    """Return all types that an annotation consists of."""
    if given := _given(annotation):
        return list(given)
    arguments = getattr(annotation, "__args__", ())
    if not arguments:
        return [annotation]
    return [inner for argument in arguments for inner in _inside(argument)]
