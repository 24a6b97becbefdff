"""Registries of what users choose by name: trackers, behaviours and export formats.

Each entry is registered once, where it stands, with the sentence that the reference prints about it. What it
needs is imported when it is first used. Other packages add entries through entry points, for example

    [project.entry-points."peopleboy.trackers"]
    my-tracker = "my_package.my_module:MyTracker"
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, TypeVar

from peopleboy.bad_input import BadInput
from peopleboy.own_code import in_one_line

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

Made = TypeVar("Made", bound=Callable[..., Any])


@dataclass(frozen=True, slots=True)
class Entry:
    """What is registered under a name.

    Attributes:
        target: the function or class, or where it is, as "module:name".
        summary: one or two sentences for the reference.
        scope: what it is for, or where it comes from, in a few words.
    """

    target: Callable[..., Any] | str
    summary: str = ""
    scope: str = ""

    def load(self) -> Callable[..., Any]:
        """Return the function or class; import its module if need be."""
        if not isinstance(self.target, str):
            return self.target
        module, _, name = self.target.partition(":")
        loaded: Callable[..., Any] = getattr(import_module(module), name)
        return loaded


class Registry(Mapping[str, Callable[..., Any]]):
    """Functions and classes by name: those that PeopleBoy ships, in order, and then those of other packages.

    Attributes:
        kind: what it holds, for messages, such as "tracker".
        group: the group of entry points through which other packages add to it.
        shipped: what PeopleBoy ships, by name.
    """

    def __init__(self, kind: str, group: str, shipped: Mapping[str, Entry] | None = None) -> None:
        self.kind, self.group = kind, group
        self.shipped = dict(shipped or {})

    def register(self, name: str, *, summary: str, scope: str = "") -> Callable[[Made], Made]:
        """Register the decorated function or class under a name."""

        def keep(target: Made) -> Made:
            self.shipped[name] = Entry(target, summary, scope)
            return target

        return keep

    def is_plugged_in(self, name: object) -> bool:
        """Whether another package provides this name."""
        return name not in self.shipped and name in plug_ins(self.group)

    def __contains__(self, name: object) -> bool:
        return name in self.shipped or name in plug_ins(self.group)

    def __iter__(self) -> Iterator[str]:
        yield from dict.fromkeys((*self.shipped, *plug_ins(self.group)))

    def __len__(self) -> int:
        return len(tuple(iter(self)))

    def __getitem__(self, name: str) -> Callable[..., Any]:
        """Load an entry.

        Raises:
            KeyError: there is none of that name.
            BadInput: several packages use the name, or that of another package cannot be loaded.
        """
        found = plug_ins(self.group).get(name, ())
        if name in self.shipped:
            if found:
                raise BadInput(
                    f"{self.kind} {name!r}: {_named(found[0])} registers a name that PeopleBoy ships; "
                    "rename that entry point or uninstall the package"
                )
            return self.shipped[name].load()
        if not found:
            raise KeyError(name)
        if len(found) > 1:
            packages = " and ".join(map(_named, found))
            raise BadInput(f"{self.kind} {name!r}: {packages} register the same name; uninstall all but one")
        return self._plugged_in(found[0])

    def _plugged_in(self, entry: "EntryPoint") -> Callable[..., Any]:
        place = f"{self.kind} {entry.name!r}: {entry.value} of {_named(entry)}"
        try:
            loaded: Any = entry.load()
        # Importing a stranger's module can raise anything; the user has to learn which package it is.
        except Exception as error:
            raise BadInput(f"{place} cannot be loaded: {in_one_line(error)}") from error
        if not callable(loaded):
            raise BadInput(f"{place} must be a class or a function, got {loaded!r}")
        called: Callable[..., Any] = loaded
        return called


@cache
def plug_ins(group: str) -> "Mapping[str, tuple[EntryPoint, ...]]":
    """List what installed packages register in a group of entry points, by name."""
    from importlib.metadata import entry_points  # here, as reading all packages takes a tenth of a second

    found: dict[str, tuple[EntryPoint, ...]] = {}
    for entry in entry_points(group=group):
        found[entry.name] = (*found.get(entry.name, ()), entry)
    return found


def _named(entry: "EntryPoint") -> str:
    return "an unnamed package" if entry.dist is None else f"package {entry.dist.name}"
