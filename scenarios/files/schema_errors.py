"""Turn what pydantic finds wrong in a scenario into one line that a person can act on."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Sequence
from typing import Any

from pydantic import BaseModel, ValidationError

_MOST_FAULTS = 3
_TAGS = ("word", "list")  # of the schema's own unions

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


def explain(error: ValidationError, model: type[BaseModel]) -> str:
    """Say where and what the faults are, at most three, on one line; misspelt keys come first.

    Args:
        error: raised by `model`.
        model: what the data should have been.
    """
    faults = [fault for fault in error.errors() if not _is_echo(fault, error.errors())]
    faults.sort(key=lambda fault: fault["type"] != "extra_forbidden")
    lines = list(dict.fromkeys(_explain_one(fault, model) for fault in faults))
    more = f"; and {len(lines) - _MOST_FAULTS} more" if len(lines) > _MOST_FAULTS else ""
    return "; ".join(lines[:_MOST_FAULTS]) + more


def hint(word: str, known: Iterable[str]) -> str:
    """Say which known word was probably meant, or list them."""
    words = sorted(known)
    close = difflib.get_close_matches(word, words, n=1, cutoff=0.6)
    return f"did you mean {close[0]!r}?" if close else f"choose from {', '.join(words)}"


def dotted(steps: Sequence[str | int]) -> str:
    """Write a path as people[0].path[1]."""
    text = "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in steps)
    return text.removeprefix(".")


def _is_echo(fault: Any, faults: Sequence[Any]) -> bool:
    """Whether a list only seems too short because an entry of it is wrong."""
    place = fault["loc"]
    return any(len(other["loc"]) > len(place) and other["loc"][: len(place)] == place for other in faults)


def _explain_one(fault: Any, model: type[BaseModel]) -> str:
    steps, owner = _follow(fault["loc"], model)
    kind, context = fault["type"], fault.get("ctx", {})
    if kind in ("extra_forbidden", "missing"):
        where = f"{dotted(steps[:-1])}: " if len(steps) > 1 else ""
        if kind == "missing" and isinstance(steps[-1], str):
            return f"{where}missing key {steps[-1]!r}"
        if kind == "extra_forbidden":
            return f"{where}unknown key {steps[-1]!r}; {hint(str(steps[-1]), owner)}"
    label = next((step for step in reversed(steps) if isinstance(step, str)), "value")
    return f"{dotted(steps)}: {_what(kind, context, fault, label)}"


def _what(kind: str, context: Any, fault: Any, label: str) -> str:
    value = _shown(fault["input"])
    if kind == "tuple_type" and fault["loc"][-1] == "list":
        return f"must be a word or a list of numbers, got {value}"
    if kind in ("literal_error", "union_tag_invalid"):
        known = re.findall(r"'([^']*)'", context.get("expected") or context["expected_tags"])
        word = context.get("tag", fault["input"])
        return f"unknown {label} {word!r}; {hint(str(word), known)}"
    if kind == "union_tag_not_found":
        return "missing key 'kind'"
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


def _follow(loc: Sequence[str | int], model: type[BaseModel]) -> tuple[list[str | int], list[str]]:
    """Drop pydantic's tags of unions from a path, and list the keys that are known at its last step."""
    steps: list[str | int] = []
    known: list[str] = []
    types: list[Any] = [model]
    for step in loc:
        models = [candidate for candidate in types if _is_model(candidate)]
        tagged = [candidate for candidate in models if _tag(candidate) == step]
        if step in _TAGS or (tagged and len(models) > 1):
            types = tagged
            continue
        steps.append(step)
        if isinstance(step, str) and models:
            known = [key for candidate in models for key in candidate.model_fields]
            fields = [c.model_fields[step].annotation for c in models if step in c.model_fields]
            # A step that is no field is the key of a mapping, and what follows is inside its value.
            types = [inner for annotation in fields for inner in _inside(annotation)] if fields else types
    return steps, known


def _is_model(candidate: Any) -> bool:
    return isinstance(candidate, type) and issubclass(candidate, BaseModel)


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
