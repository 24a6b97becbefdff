"""Read every table and figure of the sources from the files in `sources`, in the order of the page."""

import inspect
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from pathlib import Path
from typing import Annotated, Any, Final

from matplotlib.figure import Figure
from pydantic import Field, ValidationError, model_validator

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.read_yaml import read_yaml
from peopleboy.scenarios.files.validation import Strict
from peopleboy.scenarios.running.engine.store import Result
from peopleboy.studies.reproductions.canvas import png_address
from peopleboy.studies.reproductions.experiment import Experiment, Samples, Texts
from peopleboy.studies.reproductions.experiments import (
    attention,
    computing_time,
    drives,
    learning,
    panoramic_room,
    scenes,
    sliding_windows,
    tracking,
)
from peopleboy.studies.reproductions.pictures import (
    panoramic_figures,
    single_person_figures,
    situation_figures,
    tracking_figures,
)
from peopleboy.studies.reproductions.units import Measurement, Unit

SOURCES: Final[Mapping[str, str]] = {
    "thesis": "thesis_2007",
    "2005": "paper_2005",
    "panoramic": "panoramic_2003",
    "situation": "situation_awareness",
}
"""Files of the sources by name, as in `--paper`."""
FOLDER: Final = Path(__file__).with_name("sources")


_MODULES: Final = (
    *(tracking, computing_time, learning, panoramic_room, drives, sliding_windows, scenes, attention),
    *(tracking_figures, single_person_figures, panoramic_figures, situation_figures),
)


def picture(using: Measurement, *, name: str) -> str:
    """Return a picture that needs its own runs, such as "panoramic_figures.draw_set_up"."""
    (found,) = using.results([Unit(f"picture {name}", draw_picture, (name,))])
    address: str = found["picture"]
    return address


def draw_picture(name: str) -> Result:
    """Draw a figure of the folder `pictures`, and return it as a data URL."""
    module, _, function = name.partition(".")
    (found,) = (one for one in _MODULES if one.__name__.endswith(module))
    return {"picture": png_address(getattr(found, function)())}


KINDS: Final[Mapping[str, Callable[..., Any]]] = {
    name: function
    for module in (*_MODULES, sys.modules[__name__])
    for name, function in inspect.getmembers(module, inspect.isfunction)
    if not name.startswith("_")
    and inspect.signature(function).return_annotation in (Samples, Figure, Figure | None, str)
    and "using" in inspect.signature(function).parameters
}
"""Functions that measure or draw an experiment, by name; all are called with a `Measurement`."""


class Item(Strict):
    """A table or figure of a source, or a passage with values."""

    what: str
    """number in the source"""
    shows: str
    """subject"""
    here: Texts = ()
    """ids of our experiments"""
    why: str = ""
    """another place where it is covered, or why there is nothing to measure"""

    @model_validator(mode="after")
    def _stands_somewhere(self) -> "Item":
        if bool(self.here) == bool(self.why):
            raise ValueError("give either ids of experiments or a reason")
        return self


class Source(Strict):
    """A thesis or paper."""

    title: str
    """short name on the page"""
    about: str
    """description"""
    contents: Annotated[tuple[Item, ...], Field(strict=False)] = ()
    """its tables, figures and passages, in its order, as far as they are listed"""
    experiments: Annotated[tuple[Experiment, ...], Field(strict=False)]


@cache
def read_source(path: Path) -> Source:
    """Read the file of a source.

    Raises:
        BadInput: the file is invalid.
    """
    data: dict[Any, Any] = read_yaml(path)
    try:
        listed = [_experiment(path, str(number), one) for number, one in data.pop("experiments").items()]
        return Source.model_validate(data | {"experiments": listed})
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(key) for key in first["loc"])
        raise BadInput(f"{path}: {place}: {first['msg']}, got {first['input']!r}") from None


def _experiment(path: Path, number: str, data: Mapping[str, Any]) -> Experiment:
    declared = {name: data[name] for name in ("measure", "draw") if name in data}
    functions = {name: _function(f"{path}: {number}.{name}", one) for name, one in declared.items()}
    groups = tuple(declared.get("measure", {}).get("groups", ()))
    return Experiment.model_validate({"id": number, "groups": groups, **data, **functions})


def _function(place: str, declared: Mapping[str, Any]) -> Callable[[Measurement], Any]:
    """Return the function of a declaration, bound to its arguments.

    Raises:
        BadInput: the kind is unknown, or it takes other arguments.
    """
    arguments = dict(declared)
    kind = str(arguments.pop("kind", None))
    if kind not in KINDS:
        raise BadInput(f"{place}.kind: unknown kind {kind!r}; choose from {', '.join(KINDS)}")
    try:
        inspect.signature(KINDS[kind]).bind(None, **arguments)
    except TypeError as error:
        raise BadInput(f"{place}: {kind}: {error}") from None
    return partial(KINDS[kind], **arguments)


PAPERS: Final[Mapping[str, Source]] = {
    name: read_source(FOLDER / f"{file}.yaml") for name, file in SOURCES.items()
}
"""The sources by name."""

EXPERIMENTS: Final[Mapping[str, Experiment]] = {
    one.id: one for source in PAPERS.values() for one in source.experiments
}
"""Experiments by id, in the order of the page."""

_PAPER_OF: Final = {one.id: name for name, source in PAPERS.items() for one in source.experiments}


def of_paper(paper: str) -> dict[str, Experiment]:
    """Return one source's experiments by id.

    Raises:
        BadInput: the source is unknown.
    """
    if paper not in PAPERS:
        raise BadInput(f"unknown paper {paper!r}; choose from {', '.join(PAPERS)}")
    return {one.id: one for one in PAPERS[paper].experiments}


def paper_of(number: str) -> str:
    """Return the source of an experiment, one of `PAPERS`, from its id."""
    return _PAPER_OF[number]


def choose(names: Sequence[str], paper: str | None = None) -> list[Experiment]:
    """Find experiments by id or by number: "4.9" is figures 4.9a and 4.9b, "paper" all of 2005.

    Args:
        names: ids or numbers; all if omitted.
        paper: the source to search, one of `PAPERS`.

    Raises:
        BadInput: no experiment has this name.
    """
    among = EXPERIMENTS if paper is None else of_paper(paper)
    if not names:
        return list(among.values())
    chosen = {number for name in names for number in _matching(name, among)}
    return [experiment for number, experiment in among.items() if number in chosen]


def _matching(name: str, among: Mapping[str, Experiment]) -> list[str]:
    found = [number for number in among if _is_called(number, name.lower())]
    if not found:
        raise BadInput(f"unknown ID {name!r}; choose from {', '.join(among)}")
    return found


def _is_called(number: str, name: str) -> bool:
    id_ = number.lower()
    names = [id_, id_.rstrip("ab"), id_.split("-")[0]]
    if paper_of(number) == "thesis":
        last = id_.rsplit("-", 1)[-1]
        names += [last, last.rstrip("ab")]
    return name in names
