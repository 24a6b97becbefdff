"""Read YAML files as plain data: no tags, aliases or duplicate keys, and errors on one line."""

import re
from pathlib import Path
from typing import Any, Final

import yaml
from yaml.composer import Composer

from peopleboy.bad_input import BadInput, found_in
from peopleboy.user_files import is_stream

_LARGEST_BYTES = 1_000_000
# As in YAML 1.2. In YAML 1.1, 045 is octal (37), 1:30 is sexagesimal (90), and 1e3 is a string.
_WHOLE: Final = r"[-+]?(0|[1-9][0-9]*)"
_NUMBERS: Final = {
    "tag:yaml.org,2002:int": re.compile(rf"{_WHOLE}$"),
    "tag:yaml.org,2002:float": re.compile(
        rf"({_WHOLE}?\.[0-9]+|{_WHOLE}\.)([eE][-+]?[0-9]+)?$|{_WHOLE}[eE][-+]?[0-9]+$"
        r"|[-+]?\.(inf|Inf|INF)$|\.(nan|NaN|NAN)$"
    ),
}


class _Loader(Composer, yaml.CSafeLoader):
    """Load YAML strictly: only true and false are booleans, and keys and nodes are never repeated or shared.

    libyaml parses the text; its events are composed here, where each node can be checked.
    """

    def __init__(self, text: str) -> None:
        """Create a loader for a text."""
        Composer.__init__(self)
        yaml.CSafeLoader.__init__(self, text)

    def compose_node(self, parent: Any, index: Any) -> Any:
        """Refuse aliases, which let a short file expand without limit, and tags, which create objects."""
        event: Any = self.peek_event()
        fault = None
        if isinstance(event, yaml.AliasEvent):
            fault = f"alias '*{event.anchor}' is not allowed; write the value out"
        elif event.tag is not None:
            fault = f"tag {event.tag!r} is not allowed; write the plain value"
        if fault is not None:
            raise yaml.MarkedYAMLError(problem=fault, problem_mark=event.start_mark)
        return super().compose_node(parent, index)

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        """Refuse duplicate keys; PyYAML would keep the last one."""
        seen: set[str] = set()
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode):
                raise yaml.MarkedYAMLError(problem="a key must be a string", problem_mark=key.start_mark)
            if key.value in seen:
                raise yaml.MarkedYAMLError(
                    problem=f"key {key.value!r} is given twice; keep one", problem_mark=key.start_mark
                )
            seen.add(key.value)
        return super().construct_mapping(node, deep=deep)


def _is_plain(tag: str, letter: str) -> bool:
    """Return whether a scalar that starts with this letter may be resolved to the tag; others stay text."""
    kind = tag.rsplit(":", 1)[-1]
    return kind not in ("timestamp", "merge") and not (kind == "bool" and letter not in "tTfF")


_Loader.yaml_implicit_resolvers = {
    letter: [(tag, _NUMBERS.get(tag, pattern)) for tag, pattern in resolvers if _is_plain(tag, letter)]
    for letter, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()
}


def read_yaml(path: Path) -> dict[Any, Any]:
    """Read a file that contains one YAML mapping.

    Raises:
        BadInput: the file cannot be read, is not YAML, or does not contain a mapping.
    """
    with found_in(file=str(path)):
        return _parse(_read_text(path))


def _parse(text: str) -> dict[Any, Any]:
    try:
        data = yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        line = f"line {mark.line + 1}: " if mark else ""
        is_tab = mark and "".join(text.split("\n")[mark.line : mark.line + 1])[mark.column :][:1] == "\t"
        problem = "a tab, which YAML does not allow; indent with spaces" if is_tab else str(error.problem)
        raise BadInput(f"{line}{_one_line(problem)}") from error
    except RecursionError as error:
        raise BadInput("nested too deeply for a scenario") from error
    except (yaml.YAMLError, ValueError, OverflowError) as error:
        raise BadInput(f"not YAML: {_one_line(str(error))}") from error
    if data is None:
        raise BadInput("the file is empty; it must hold keys such as 'name' and 'place'")
    if not isinstance(data, dict):
        raise BadInput(f"must contain keys such as 'name' and 'place', got a {type(data).__name__}")
    return data


def _read_text(path: Path) -> str:
    try:
        if path.is_dir():
            raise BadInput("is a folder; give a scenario file that ends in .yaml")
        if is_stream(path):
            raise BadInput("is a pipe or a device; give a scenario file that ends in .yaml")
        with path.open("rb") as file:
            data = file.read(_LARGEST_BYTES + 1)
    except FileNotFoundError as error:
        raise BadInput("file not found") from error
    except OSError as error:
        raise BadInput(f"cannot be read: {error.strerror}") from error
    if len(data) > _LARGEST_BYTES:
        raise BadInput(f"has {path.stat().st_size} bytes; a scenario file has at most {_LARGEST_BYTES}")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise BadInput(f"is not UTF-8 text (byte {error.start})") from error


def _one_line(text: str) -> str:
    return " ".join(text.split())
