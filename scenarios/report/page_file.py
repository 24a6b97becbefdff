"""The file of a page, which replaces nothing but an earlier report."""

from __future__ import annotations

import re
from contextlib import suppress
from pathlib import Path

from peopleboy.bad_input import BadInput

_ENDINGS = (".html", ".htm")
_REPORT = re.compile(rb"<title>[^<]*: PeopleBoy report</title>")
_HEAD_BYTES = 20_000  # within which the title stands


def check_place(out: Path) -> None:
    """Refuse a file that is no place for a report.

    Raises:
        BadInput: it is a folder, does not end in .html or .htm, or holds something else than a report.
    """
    try:
        if out.is_dir():
            raise BadInput(f"{out}: is a folder; give --out a file that ends in .html")
        is_other = out.exists() and not _is_report(out)
    except OSError as error:
        raise _cannot(out, error) from error
    is_page = out.suffix.lower() in _ENDINGS
    if is_other:
        advice = "give another --out" if is_page else "give --out a file that ends in .html"
        raise BadInput(f"{out}: is no report and will not be replaced; {advice}")
    if not is_page:
        raise BadInput(f"{out}: a report is a page; give --out a file that ends in .html")


def write_page(text: str, out: Path) -> None:
    """Write a page, whole or not at all.

    Raises:
        BadInput: it cannot be written there.
    """
    part = out.with_name(f"{out.name}.part")
    try:
        part.write_text(text, encoding="utf-8")
        part.replace(out)
    except OSError as error:
        with suppress(OSError):
            part.unlink()
        raise _cannot(out, error) from error


def _is_report(path: Path) -> bool:
    """Whether a file begins as reports do, those of earlier versions too."""
    with path.open("rb") as file:
        return _REPORT.search(file.read(_HEAD_BYTES)) is not None


def _cannot(out: Path, error: OSError) -> BadInput:
    return BadInput(f"{out}: cannot write the page: {error.strerror}; give another --out")
