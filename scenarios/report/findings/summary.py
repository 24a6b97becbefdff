"""What came out, in one sentence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from peopleboy.scenarios.report.findings.endings import Ending, how_it_ended
from peopleboy.scenarios.report.findings.finished_run import FinishedRun
from peopleboy.scenarios.report.findings.identities import (
    Change,
    Fleeting,
    Loss,
    Stray,
    count_fleeting,
    find_changes,
    find_losses,
    find_strays,
)
from peopleboy.scenarios.report.findings.sentences import listed, seconds, spoken, times
from peopleboy.scenarios.report.findings.story import Story, tell_stories
from peopleboy.wording import counted


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Outcome:
    """A run, and what is found out about it."""

    run: FinishedRun
    stories: tuple[Story, ...]
    changes: tuple[Change, ...]
    losses: tuple[Loss, ...]
    fleeting: Fleeting
    strays: tuple[Stray, ...]

    @property
    def due(self) -> int:
        """How many people were to be tracked at some time."""
        return sum(bool(story.is_due.any()) for story in self.stories)

    def who_ended(self, *endings: Ending) -> list[str]:
        """Name those with whom it ended in one of these ways."""
        return [spoken(story.name) for story in self.stories if how_it_ended(self.run, story) in endings]

    @property
    def lost(self) -> list[Change]:
        """Changes of numbers of people who had been in the image nearly all the time."""
        return [change for change in self.changes if not change.is_return]

    @property
    def returned(self) -> list[Change]:
        """New numbers of people who came back into the image."""
        return [change for change in self.changes if change.is_return]

    @property
    def touched(self) -> list[tuple[float, str]]:
        """When [s] the robot touched whom or what."""
        return [(line.time_s, line.other) for line in self.run.events if line.kind == "contact starts"]


def look_into(run: FinishedRun) -> Outcome:
    """Find out what became of everybody in a run."""
    stories = tell_stories(run)
    return Outcome(
        run=run,
        stories=tuple(stories),
        changes=tuple(find_changes(run, stories)),
        losses=tuple(find_losses(run, stories)),
        fleeting=count_fleeting(run),
        strays=tuple(find_strays(run, stories)),
    )


def headline(outcome: Outcome) -> str:
    """Say of one run who was tracked to the end, and where identities were lost."""
    parts = [_people(outcome), _identities(outcome)] if outcome.due else ["Nobody was there to be found"]
    if outcome.returned:
        parts.append(_returns(len(outcome.returned)))
    if outcome.strays:
        parts.append(f"{counted(len(outcome.strays), 'track')} on nobody")
    if outcome.touched:
        first_s, _ = outcome.touched[0]
        names = listed(list(dict.fromkeys(spoken(who) for _, who in outcome.touched)))
        parts.append(f"the robot touched {names}, first at {seconds(first_s)}")
    return "; ".join(parts) + "."


def headline_of_many(outcomes: Sequence[Outcome]) -> str:
    """Say the same of several runs."""
    due = sum(o.due for o in outcomes)
    tracked, hidden = (
        sum(len(o.who_ended(ending)) for o in outcomes) for ending in (Ending.TRACKED, Ending.HIDDEN)
    )
    lost, returned = sum(len(o.lost) for o in outcomes), sum(len(o.returned) for o in outcomes)
    where = sum(bool(o.lost) for o in outcomes)
    strays, touches = sum(len(o.strays) for o in outcomes), sum(len(o.touched) for o in outcomes)
    identities = f"identity lost {times(lost)}, in {counted(where, 'run')}" if lost else "no identity lost"
    parts = [
        f"{counted(len(outcomes), 'run')}: of {counted(due, 'person', 'people')} {tracked} tracked to the end"
    ]
    parts[0] += f", {hidden} hidden until the end" if hidden else ""
    parts += [
        identities,
        *([_returns(returned)] if returned else []),
        f"{counted(strays, 'track')} on nobody",
    ]
    parts += [f"{counted(touches, 'contact')} of the robot"] if touches else []
    return "; ".join(parts) + "."


def _returns(count: int) -> str:
    return f"{times(count)} somebody came back into the image under a new number"


def _people(outcome: Outcome) -> str:
    due, hidden = outcome.due, outcome.who_ended(Ending.HIDDEN)
    others = outcome.who_ended(Ending.LOST, Ending.HIDDEN)
    tracked = due - len(others)
    asides = [f"{listed(hidden)} hidden until the end"] if hidden and due > 1 else []
    never = len(outcome.stories) - due
    asides += [f"{never} more never came within 3 to 10 m in sight"] if never else []
    aside = f" ({'; '.join(asides)})" if asides else ""
    if due == 1:
        how = "hidden until" if hidden else "tracked to" if tracked else "not tracked to"
        return f"1 person, {how} the end{aside}"
    which = {0: "none", due: "both" if due == 2 else "all"}.get(tracked, f"all but {listed(others)}")
    return f"{due} people, {which} tracked to the end{aside}"


def _identities(outcome: Outcome) -> str:
    if not outcome.lost:
        return "no identity lost"
    first = outcome.lost[0]
    when = f"at {seconds(first.time_s)}, when {spoken(first.person)} {first.why}"
    count = len(outcome.lost)
    return f"identity lost once, {when}" if count == 1 else f"identity lost {times(count)}, first {when}"
