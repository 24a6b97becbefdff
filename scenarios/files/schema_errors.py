"""Turn what pydantic finds wrong in a scenario into one line that a person can act on."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Sequence
from typing import Any, TypeVar, get_origin

from pydantic import BaseModel, ValidationError

from peopleboy.bad_input import BadInput, Key

M = TypeVar("M", bound=BaseModel)

_MOST_FAULTS = 3
_TAGS = ("word", "list", "values")  # of the schema's own unions

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
    "model_type": "must be a mapping of keys to values",
    "model_attributes_type": "must be a mapping of keys to values",
    "string_too_short": "must not be empty",
    "string_too_long": "must have at most {max_length} letters",
    "too_short": "must have at least {min_length} entries",
    "too_long": "must have at most {max_length} entries",
}


def validated(model: type[M], data: object) -> M:
    """Make a model of data.

    Raises:
        BadInput: with where and what the faults are, at most three, misspelt keys first.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise _explain(error, model) from error


def _explain(error: ValidationError, model: type[BaseModel]) -> BadInput:
    faults = [fault for fault in error.errors() if not _is_echo(fault, error.errors())]
    faults.sort(key=lambda fault: fault["type"] != "extra_forbidden")
    found = [_explain_one(fault, model) for fault in faults]
    lines = list(dict.fromkeys(map(str, found)))
    if len(lines) == 1:
        return found[0]
    more = f"; and {len(lines) - _MOST_FAULTS} more" if len(lines) > _MOST_FAULTS else ""
    return BadInput("; ".join(lines[:_MOST_FAULTS]) + more)


def hint(word: str, known: Iterable[str], listed: str | None = None) -> str:
    """Say which known word was probably meant; or list them, or say where they are listed."""
    words = sorted(known)
    close = difflib.get_close_matches(word, words, n=1, cutoff=0.6)
    if close:
        return f"did you mean {close[0]!r}?"
    return f"choose from {', '.join(words)}" if listed is None else listed


def _is_echo(fault: Any, faults: Sequence[Any]) -> bool:
    """Whether a list only seems too short because an entry of it is wrong."""
    place = fault["loc"]
    return any(len(other["loc"]) > len(place) and other["loc"][: len(place)] == place for other in faults)


def _explain_one(fault: Any, model: type[BaseModel]) -> BadInput:
    steps, owner, kinds, words = _follow(fault["loc"], model)
    kind, context = fault["type"], fault.get("ctx", {})
    if kind == "union_tag_not_found":
        return BadInput(f"missing key 'kind'; choose from {', '.join(kinds)}", key=steps)
    if kind == "missing" and isinstance(steps[-1], str):
        choice = f"; choose from {', '.join(words)}" if words else ""
        return BadInput(f"missing key {steps[-1]!r}{choice}", key=steps[:-1])
    if kind == "extra_forbidden":
        return BadInput(f"unknown key {steps[-1]!r}; {hint(str(steps[-1]), owner)}", key=steps[:-1])
    if steps and steps[-1] == "[key]":  # pydantic's, of a key that is wrong itself
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
        return f"unknown {what} {word!r}; {hint(str(word), known)}"
    if kind == "string_pattern_mismatch" and label in ("tracker", "behaviour") and ":" in fault["input"]:
        return f"{value} is a class of your own, which no file names; give --{label} {fault['input']} instead"
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


def _follow(loc: Sequence[str | int], model: type[BaseModel]) -> tuple[Key, list[str], list[str], list[str]]:
    """Drop pydantic's tags of unions from a path, and list the keys, kinds and words known at its end."""
    steps: list[str | int] = []
    known: list[str] = []
    types: list[Any] = [model]
    is_key = False
    for step in loc:
        models = [candidate for candidate in types if _is_model(candidate)]
        tagged = [candidate for candidate in models if _tag(candidate) == step]
        if not is_key and (step in _TAGS or (tagged and len(models) > 1)):
            types = tagged
            continue
        steps.append(step)
        if not is_key and isinstance(step, str) and models:
            known = [f.alias or key for candidate in models for key, f in candidate.model_fields.items()]
            fields = [c.model_fields[step].annotation for c in models if step in c.model_fields]
            types = [inner for annotation in fields for inner in _inside(annotation)] if fields else types
            # What follows is a key, however much it looks like a tag, and then inside its value.
            is_key = any(_is_mapping(annotation) for annotation in fields)
        else:
            is_key = False
    kinds = sorted({tag for candidate in types if _is_model(candidate) and (tag := _tag(candidate))})
    return tuple(steps), known, kinds, sorted(word for word in types if isinstance(word, str))


def _is_model(candidate: Any) -> bool:
    return isinstance(candidate, type) and issubclass(candidate, BaseModel)


def _is_mapping(annotation: Any) -> bool:
    return get_origin(annotation) is dict


def _tag(model: type[BaseModel]) -> str:
    kind = model.model_fields.get("kind")
    values = getattr(kind.annotation, "__args__", ("",)) if kind else ("",)
    return str(values[0])


def _inside(annotation: Any) -> list[Any]:
    """All types that an annotation is made of."""
    arguments = getattr(annotation, "__args__", ())
    if not arguments:
        return [annotation]
    return [inner for argument in arguments for inner in _inside(argument)]
