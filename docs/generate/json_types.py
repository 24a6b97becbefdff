"""Descriptions of JSON schema types."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from docs.generate.markdown import words
from peopleboy.sim.shapes.materials import COLOURS

Schema = dict[str, Any]


def title(part: str) -> str:
    """Convert a class name of the schema to a heading: LCorridorSpec becomes L corridor."""
    return re.sub(r"(?<!^)([A-Z])", r" \1", part.removesuffix("Spec").removesuffix("Config")).capitalize()


def type_text(field: Schema) -> str:
    """Describe the values of a field."""
    options = [option for option in _options(field) if option.get("type") != "null"]
    return ", or ".join(dict.fromkeys(_one(option) for option in options))


def default_text(field: Schema) -> str:
    """Describe the default of a field."""
    if "$ref" in field and "default" not in field:
        return "see below"
    default = field.get("default")
    if default is None:
        return ""
    if isinstance(default, bool):
        return "yes" if default else "no"
    if isinstance(default, dict):
        return "see below" if default else "none"
    if isinstance(default, list):
        return f"`{', '.join(map(str, default))}`" if default else "none"
    return f"`{default}`"


def models_in(value: Any) -> Iterator[str]:
    """Yield the classes to which a part of the schema refers, in order."""
    if isinstance(value, dict):
        if "$ref" in value:
            yield value["$ref"].rsplit("/", 1)[-1]
        for key, inner in value.items():
            if key != "discriminator":
                yield from models_in(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from models_in(inner)


def _options(field: Schema) -> list[Schema]:
    for key in ("anyOf", "oneOf"):
        if key in field:
            return [inner for option in field[key] for inner in _options(option)]
    return [field]


def _one(field: Schema) -> str:
    if "$ref" in field:
        name = title(next(models_in(field)))
        return f"[{name}](#{name.lower().replace(' ', '-')})"
    if "enum" in field:
        is_colour = set(field["enum"]) == set(COLOURS)
        return "a [colour](#named-colours)" if is_colour else words(field["enum"])
    if "const" in field:
        return f"`{field['const']}`"
    return _KINDS[field["type"]](field)


def _number(field: Schema) -> str:
    low, high = field.get("minimum"), field.get("maximum")
    above = field.get("exclusiveMinimum")
    start = f"more than {above:g}" if above is not None else "" if low is None else f"{low:g}"
    return start if high is None else f"{start} to {high:g}" if start else f"up to {high:g}"


def _text(field: Schema) -> str:
    return "a name" if "pattern" in field else "text"


def _list(field: Schema) -> str:
    if "prefixItems" in field:
        items = field["prefixItems"]
        return f"{len(items)} numbers, each {_number(items[0])}"
    inner = type_text(field["items"])
    low, high = field.get("minItems", 0), field.get("maxItems")
    count = "" if high is None else f"up to {high} " if low == 0 else f"{low} to {high} "
    return f"list of {count}{'names' if inner == 'a name' else inner}"


def _mapping(field: Schema) -> str:
    inner = field.get("additionalProperties") or next(iter(field["patternProperties"].values()))
    text = type_text(inner)
    return f"mapping of names to {'numbers, each ' * ('type' in inner and inner['type'] == 'number')}{text}"


_KINDS = {
    "number": _number,
    "integer": lambda field: (
        f"integer, {_number(field)}" if "maximum" in field else f"integer, at least {_number(field)}"
    ),
    "boolean": lambda _: "`true`, `false`",
    "string": _text,
    "array": _list,
    "object": _mapping,
}
