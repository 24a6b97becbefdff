"""Generate the tables of tracker settings, with the values in the main trackers."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

from docs.generate.markdown import table
from peopleboy.tracker.reproductions.contour import contour_config as source
from peopleboy.tracker.reproductions.contour.contour_config import FilterConfig, LimitsConfig, TrackerConfig
from peopleboy.tracker.reproductions.contour.variants import CONTOUR, PAPER, THESIS_OCCLUSION

COLUMNS: Mapping[str, TrackerConfig] = {
    "thesis": THESIS_OCCLUSION,
    "paper": PAPER,
    "contour": CONTOUR,
}


@dataclass(frozen=True, slots=True)
class CommentedSetting:
    """One field of a settings class: name, default, and the comment next to or above it."""

    name: str
    default: str
    comment: str


def settings() -> str:
    """List every setting with its meaning and its value in the main trackers."""
    text = inspect.getsource(source)
    parts = []
    for part in fields(TrackerConfig):
        given = {name: getattr(config, part.name) for name, config in COLUMNS.items()}
        kinds = dict.fromkeys(type(value) for value in given.values() if value is not None)
        for kind in kinds:
            if kind.__module__ == source.__name__:
                own = {name: value if isinstance(value, kind) else None for name, value in given.items()}
                title = f"`{part.name}`" if len(kinds) == 1 else f"`{part.name}`: `{kind.__name__}`"
                parts.append(_section(title, kind, commented_settings(text, kind.__name__), own))
        if kind is FilterConfig:
            limits = {name: config.limits for name, config in given.items()}
            parts.append(
                _section(
                    f"`{part.name}.limits`", LimitsConfig, commented_settings(text, "LimitsConfig"), limits
                )
            )
    return "\n".join(parts)


def commented_settings(text: str, kind: str) -> list[CommentedSetting]:
    """Read the fields of a class and their comments from the source code."""
    lines = text.splitlines()
    body = next(
        node for node in ast.parse(text).body if isinstance(node, ast.ClassDef) and node.name == kind
    ).body
    found = []
    for node in body:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            default = "" if node.value is None else ast.unparse(node.value)
            found.append(CommentedSetting(node.target.id, default, _comment(lines, node)))
    return found


def _section(title: str, kind: type[Any], found: list[CommentedSetting], given: Mapping[str, Any]) -> str:
    rows = []
    for setting in found:
        values = [_value(config, setting.name, kind) for config in given.values()]
        rows.append((f"`{setting.name}`", setting.comment, *values))
    about = inspect.cleandoc(kind.__doc__ or "")
    return f"## {title}\n\n{about}\n\n{table(('setting', 'meaning', *given), rows)}"


def _comment(lines: list[str], node: ast.AnnAssign) -> str:
    """Join the comment lines directly above a field and the comment behind it."""
    first, last = node.lineno - 1, (node.end_lineno or node.lineno) - 1
    above: list[str] = []
    while lines[first - 1].lstrip().startswith("# "):
        first -= 1
        above.insert(0, lines[first].strip("# "))
    inside = [line.partition("  # ")[2] for line in lines[node.lineno - 1 : last + 1]]
    return " ".join([*above, *inside]).strip()


def _value(config: Any, name: str, kind: type[Any]) -> str:
    if config is None:
        return "off"
    value = getattr(config, name)
    if is_dataclass(value):
        return "see below"
    text = ", ".join(f"{part:g}" for part in value) if isinstance(value, tuple) else _plain(value)
    return text if value == getattr(kind(), name) else f"**{text}**"


def _plain(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.3g}" if isinstance(value, float) else str(value)
