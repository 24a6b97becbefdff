"""How it ended with each person of a run."""

from __future__ import annotations

from enum import Enum, auto

import numpy as np

from peopleboy.scenarios.report.findings.finished_run import FinishedRun
from peopleboy.scenarios.report.findings.spans import Ints, settle
from peopleboy.scenarios.report.findings.story import Sight, Story, steady_frames


class Ending(Enum):
    """How it ended with a person."""

    NEVER_DUE = auto()
    TRACKED = auto()
    HIDDEN = auto()  # tracked until wholly hidden, which lasted to the end
    LOST = auto()


def how_it_ended(run: FinishedRun, story: Story) -> Ending:
    """Tell whether a track lay on the person in the last second of being due, and what came then."""
    due = steadily_due(run, story)
    if len(due) == 0:
        return Ending.NEVER_DUE
    last = due[due > due[-1] - round(run.rate_hz)]
    if not (story.track[last] > 0).any():
        return Ending.LOST
    return Ending.HIDDEN if _is_hidden_to_end(run, story) else Ending.TRACKED


def steadily_due(run: FinishedRun, story: Story) -> Ints:
    """Give the indices at which a person is due for more than a glimpse; of glimpses if there is no more."""
    steady = np.flatnonzero(settle(story.is_due.astype(np.int64), steady_frames(run)))
    return steady if len(steady) else np.flatnonzero(story.is_due)


def _is_hidden_to_end(run: FinishedRun, story: Story) -> bool:
    """Whether a person whom no track lies on any more was wholly hidden to the end, but for moments."""
    after = story.sight[np.flatnonzero(story.track)[-1] + 1 :]
    hidden = np.flatnonzero(after == Sight.WHOLLY)
    if len(hidden) == 0:
        return False
    in_view = np.isin(after[hidden[0] :], (Sight.SEEN, Sight.PARTLY)).astype(np.int64)
    return Sight.AWAY not in after and not settle(in_view, steady_frames(run)).any()
