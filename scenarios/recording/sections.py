"""The sections of contours, coloured by what the image says for them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from scenarios.palette import Rgb
from scenarios.recording.marks import Lines, colours_of
from tracker.config import TrackerConfig
from tracker.contour import FEET
from tracker.ellipse import section_lines
from tracker.evidence import Evidence
from tracker.track import Track

# ColorBrewer's RdYlBu without its dark ends: against a person, undecided, for one.
_AGAINST, _UNDECIDED, _FOR = (215, 48, 39), (255, 255, 191), (69, 117, 180)
OUT_OF_VIEW: Rgb = (110, 110, 110)
_HALF = 0.5  # share of a section that must be in view


def section_marks(tracks: Sequence[Track], evidence: Mapping[int, Evidence], config: TrackerConfig) -> Lines:
    """Draw every section of every track, from red, against a person, by pale yellow, undecided, to blue.

    Undecided is the threshold of the fitness. What is mostly hidden or outside the image is grey.
    """
    lines, colours = [], []
    drawn = FEET + 1 if config.contour.feet_weight > 0 else FEET
    for track in tracks:
        its = evidence[track.id]
        for section, line in enumerate(section_lines(track.ellipse, config.contour)[:drawn]):
            lines.append(line.astype(np.float32))
            is_seen = its.seen[section] >= _HALF
            share = float(its.response[section]) / (2.0 * config.likelihood.threshold)
            colours.append(_shade(share) if is_seen else OUT_OF_VIEW)
    return Lines(lines, colours_of(colours))


def _shade(share: float) -> Rgb:
    """Go from red at 0 by pale yellow at 0.5 to blue at 1."""
    low, high, part = (_AGAINST, _UNDECIDED, 2 * share) if share < 0.5 else (_UNDECIDED, _FOR, 2 * share - 1)
    mixed = np.array(low) + (np.array(high) - np.array(low)) * min(max(part, 0.0), 1.0)
    red, green, blue = (round(float(value)) for value in mixed)
    return red, green, blue
