"""Values by name, each made when a person first asks for it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TypeVar

V = TypeVar("V")


class OnDemand(Mapping[str, V]):
    """A mapping whose names are known, and whose values are made when first asked for, and then kept.

    Args:
        names: in their order.
        make: gives the value of a name.
        made: values that are there already.
    """

    def __init__(
        self, names: Iterable[str], make: Callable[[str], V], made: Mapping[str, V] | None = None
    ) -> None:
        self._names = dict.fromkeys(names)
        self._make = make
        self._made: dict[str, V] = {} if made is None else dict(made)

    def __getitem__(self, name: str) -> V:
        if name not in self._names:
            raise KeyError(name)
        if name not in self._made:
            self._made[name] = self._make(name)
        return self._made[name]

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)
