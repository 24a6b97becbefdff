"""The file of a page, which replaces nothing but an earlier report."""

from __future__ import annotations

import re
from pathlib import Path

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.atomic_output import atomic, writing_to

_ENDINGS = (".html", ".htm")
_REPORT = re.compile(rb"<title>[^<]*: PeopleBoy report</title>")
_HEAD_BYTES = 20_000  # within which the title stands


def check_place(out: Path) -> None:
    """Refuse a file that is no place for a report.

    Raises:
        BadInput: it is a folder, does not end in .html or .htm, or holds something else than a report.
    """
    with writing_to(out):
        is_other = out.is_dir() or (out.exists() and not _is_report(out))
    is_page = out.suffix.lower() in _ENDINGS and not out.is_dir()
    what = "is a folder" if out.is_dir() else "is no report and will not be replaced" if is_other else ""
    if what or not is_page:
        advice = "give another --out" if is_page else "give --out a file that ends in .html"
        raise BadInput(f"{out}: {what or 'a report is a page'}; {advice}")


def write_page(text: str, out: Path) -> None:
    """Write a page, whole or not at all.

    Raises:
        BadInput: it cannot be written there.
    """
    with writing_to(out), atomic(out) as part:
        part.write_text(text, encoding="utf-8")


def _is_report(path: Path) -> bool:
    """Whether a file begins as reports do, those of earlier versions too."""
    with path.open("rb") as file:
        return _REPORT.search(file.read(_HEAD_BYTES)) is not None
