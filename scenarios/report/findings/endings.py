"""How it ended with each person of a run."""

from __future__ import annotations

from enum import Enum, auto

import numpy as np

from peopleboy.scenarios.report.findings.spans import Ints, settle
from peopleboy.scenarios.report.findings.story import PersonView, RunStory, Story


class Ending(Enum):
    """How it ended with a person."""

    NEVER_DUE = auto()
    TRACKED = auto()
    HIDDEN = auto()  # tracked until wholly hidden, which lasted to the end
    LOST = auto()


def how_it_ended(story: RunStory, person: Story) -> Ending:
    """Tell whether a track lay on a person in the last second of being due, and what came then."""
    due = steadily_due(story, person)
    if len(due) == 0:
        return Ending.NEVER_DUE
    last = due[due > due[-1] - round(story.run.rate_hz)]
    if not (person.track[last] > 0).any():
        return Ending.LOST
    return Ending.HIDDEN if _is_hidden_to_end(story, person) else Ending.TRACKED


def steadily_due(story: RunStory, person: Story) -> Ints:
    """Give the indices at which a person is due for more than a glimpse; of glimpses if there is no more."""
    steady = np.flatnonzero(settle(person.is_due.astype(np.int64), story.steady))
    return steady if len(steady) else np.flatnonzero(person.is_due)


def _is_hidden_to_end(story: RunStory, person: Story) -> bool:
    """Whether a person whom no track lies on any more was wholly hidden to the end, but for moments."""
    after = person.view[np.flatnonzero(person.track)[-1] + 1 :]
    hidden = np.flatnonzero(after == PersonView.WHOLLY)
    if len(hidden) == 0:
        return False
    in_view = np.isin(after[hidden[0] :], (PersonView.SEEN, PersonView.PARTLY)).astype(np.int64)
    return PersonView.AWAY not in after and not settle(in_view, story.steady).any()
