"""The file of people that a tracker knows: read before a run, and written after it."""

from collections.abc import Callable
from pathlib import Path
from typing import Final

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.atomic_output import write_aside, writing_to
from peopleboy.tracker.frame import COLOUR, DEPTH, PANORAMA
from peopleboy.tracker.trackers import Tracker, UsesGallery

_COLOURED: Final = frozenset({COLOUR, DEPTH, PANORAMA})
"""Cameras with colour images."""


def use_gallery(tracker: Tracker, name: str, path: Path | None, out: Path) -> Callable[[], None]:
    """Give a tracker the people of a file, and return what writes them after the run.

    Args:
        tracker: the tracker, before its first frame.
        name: its name, for the message.
        path: of the file, which need not exist; None for no gallery.
        out: folder of the run, which may be replaced, and so must not contain the file.

    Raises:
        BadInput: the tracker has no gallery or no colours, or the file cannot be read or is in a wrong place.
    """
    if path is None:
        return lambda: None
    from peopleboy.tracker.tracking.people_gallery import PeopleGallery, read_gallery

    if not isinstance(tracker, UsesGallery):
        raise BadInput(f"--gallery {path}: tracker {name!r} has no gallery of people; leave it out")
    if not _COLOURED.intersection(tracker.cameras):
        raise BadInput(f"--gallery {path}: tracker {name!r} has no colours of people; leave it out")
    if path.resolve().is_relative_to(out.resolve()):
        raise BadInput(f"--gallery {path}: lies in the output folder {out}; give a file outside it")
    if not path.parent.is_dir():
        raise BadInput(f"--gallery {path}: there is no folder {path.parent}; make it, or give another file")
    gallery = read_gallery(path) if path.exists() else PeopleGallery()
    tracker.use_gallery(gallery)

    def save() -> None:
        with writing_to(path, "--gallery"):
            write_aside(path, gallery.to_text().encode())

    return save
