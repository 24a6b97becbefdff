"""Embed matplotlib figures in a page as SVG, and write the page; only earlier reports are overwritten.

The SVG is reproducible byte by byte, and has no ids that could clash.
"""

import base64
import io
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Final

import jinja2
import matplotlib
from markupsafe import Markup, escape
from matplotlib.artist import Artist
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.atomic_output import atomic, writing_to

INK: Final = "#1c2430"
SOFT: Final = "#54606f"
LINE: Final = "#d5dbe3"
SERIES: Final = ("#0072b2", "#d55e00", "#009e73", "#a8327a")  # Okabe and Ito; dark enough for lines on white

_PER_INCH: Final = 72.0
_SAYS: Final = "says "
_NOTHING: Final = dict.fromkeys(("Creator", "Date", "Format", "Type"))

# A $ in a name does not start a formula.
svg_style = matplotlib.rc_context(
    {
        "text.parse_math": False,
        "font.family": "sans-serif",
        "font.sans-serif": ["DejaVu Sans"],
        "font.size": 8.5,
        "text.color": INK,
        "axes.labelcolor": SOFT,
        "xtick.color": SOFT,
        "ytick.color": SOFT,
        "xtick.labelcolor": INK,
        "ytick.labelcolor": INK,
    }
)
"""Decorator that sets the style of drawing functions."""


def new_figure(width_pt: float, height_pt: float) -> Figure:
    """Return an empty figure with a transparent background."""
    figure = Figure((width_pt / _PER_INCH, height_pt / _PER_INCH), facecolor="none")
    FigureCanvasSVG(figure)
    return figure


def set_tooltip(artist: Artist, words: str) -> None:
    """Set the tooltip of an artist."""
    artist.set_gid(_SAYS + words)


def inline(figure: Figure, name: str, words: str = "") -> Markup:
    """Return a figure as an element of a page.

    Args:
        figure: the figure to embed.
        name: name of the figure, unique on a page.
        words: text alternative; empty for a decorative figure.
    """
    file = io.StringIO()
    # Text stays text, so that it can be searched.
    with matplotlib.rc_context({"svg.hashsalt": name, "svg.fonttype": "none"}):
        figure.savefig(file, format="svg", metadata=_NOTHING)
    drawn = re.sub(r"<(metadata|style).*?</\1>|<g id=[^>]*/>", "", file.getvalue(), flags=re.DOTALL)
    head, body = re.split(r"<svg[^>]*>", drawn)
    box = re.search(r'viewBox="[^"]*"', file.getvalue())
    assert box is not None, head
    role = f'role="img" aria-label="{escape(words)}"' if words else 'aria-hidden="true"'
    groups = re.sub(r'<g id="([^"]*)">', _group, body)
    return Markup(f"<svg {box[0]} {role}>{groups.strip()}")


def _group(found: re.Match[str]) -> str:
    """Return the start of a group without its id, with its tooltip."""
    return f"<g><title>{found[1].removeprefix(_SAYS)}</title>" if found[1].startswith(_SAYS) else "<g>"


_ENDINGS = (".html", ".htm")
_REPORT = re.compile(rb"<title>[^<]*: PeopleBoy report</title>")
_HEAD_BYTES = 20_000  # within which the title must be


def check_place(out: Path) -> None:
    """Refuse a file that a report cannot be written to.

    Raises:
        BadInput: it is a folder, does not end in .html or .htm, or contains something other than a report.
    """
    with writing_to(out):
        is_other = out.is_dir() or (out.exists() and not _is_report(out))
    is_page = out.suffix.lower() in _ENDINGS and not out.is_dir()
    what = "is a folder" if out.is_dir() else "is not a report and will not be replaced" if is_other else ""
    if what or not is_page:
        advice = "give another --out" if is_page else "give --out a file that ends in .html"
        raise BadInput(f"{out}: {what or 'a report is an HTML page'}; {advice}")


def write_page(text: str, out: Path) -> None:
    """Write a page, completely or not at all.

    Raises:
        BadInput: it cannot be written there.
    """
    with writing_to(out), atomic(out) as part:
        part.write_text(text, encoding="utf-8")


def render_page(
    template: str,
    folders: Sequence[Path],
    filters: Mapping[str, Callable[..., object]] | None = None,
    **content: object,
) -> str:
    """Render a page as HTML from a template in one of these folders, with further filters."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(folders),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= filters or {}
    return environment.get_template(template).render(**content)


def data_address(media_type: str, content: bytes) -> str:
    """Return the data URL that embeds a file, such as a picture, in a page."""
    return f"data:{media_type};base64,{base64.b64encode(content).decode()}"


def _is_report(path: Path) -> bool:
    """Return whether a file is a report, of this or an earlier version."""
    with path.open("rb") as file:
        return _REPORT.search(file.read(_HEAD_BYTES)) is not None
