"""Generate the tables of scenario keys from the JSON schema."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from docs.generate.json_types import default_text, models_in, title, type_text
from docs.generate.markdown import sentence, table
from peopleboy.scenarios.files.scenario_file import json_schema
from peopleboy.settings import unit_of


@dataclass(frozen=True, slots=True)
class Key:
    """One key of a part of a scenario file."""

    part: str
    name: str
    unit: str
    values: str
    default: str
    meaning: str


def scenario_keys() -> str:
    """List the keys of every part under a separate heading."""
    return "\n".join(_section(name, part) for name, part in parts_of_a_file().items())


def keys_of(parts: Mapping[str, dict[str, Any]]) -> Iterator[Key]:
    """List every key of given parts of a scenario file."""
    for part, model in parts.items():
        for name, field in model["properties"].items():
            is_required = name in model.get("required", ())
            yield Key(
                part=part,
                name=name,
                unit=unit_of(name),
                values=type_text(field),
                default="**required**" if is_required else default_text(field),
                meaning=sentence(field.get("description", "")),
            )


def parts_of_a_file() -> Mapping[str, dict[str, Any]]:
    """Return the parts of a scenario file by class name, each after the part in which it is first used."""
    whole = json_schema()
    whole["required"] = whole["anyOf"][0]["required"]
    parts = {"ScenarioSpec": whole}
    waiting = ["ScenarioSpec"]
    while waiting:
        found = [name for name in models_in(parts[waiting.pop(0)]["properties"]) if name not in parts]
        parts |= {name: whole["$defs"][name] for name in found}
        waiting += found
    return parts


def _section(name: str, model: dict[str, Any]) -> str:
    heading = "The whole file" if name == "ScenarioSpec" else title(name)
    rows = [
        (f"`{key.name}`", key.unit, key.values, key.default, key.meaning) for key in keys_of({name: model})
    ]
    head = ("key", "unit", "values", "default", "meaning")
    return f"## {heading}\n\n{sentence(model['description'])}\n\n{table(head, rows)}"
