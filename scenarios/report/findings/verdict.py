"""What came out, in one sentence: numbers that went to somebody else first, as nothing is graver."""

from __future__ import annotations

from collections.abc import Sequence

from peopleboy.scenarios.report.findings.changes import Change, Passing
from peopleboy.scenarios.report.findings.endings import Ending
from peopleboy.scenarios.report.findings.sentences import listed, seconds, spoken, times
from peopleboy.scenarios.report.findings.summary import RunFindings
from peopleboy.wording import counted


def headline(found: RunFindings) -> str:
    """Say of one run who was tracked to the end, and where identities were lost."""
    parts = [_passings(found.passings)] if found.passings else []
    parts += [_people(found), *_identities(found)] if found.due else ["Nobody was there to be found"]
    if len(found.known_again) == 1:
        (one,) = found.known_again
        after = f"after {seconds(one.known_after_s)} as number {one.old}"
        parts.append(f"{spoken(one.person)} was known again as number {one.new} {after}")
    elif found.known_again:
        parts.append(_known_again(found.known_again))
    if found.strays:
        parts.append(f"{counted(len(found.strays), 'track')} on nobody")
    if found.contacts:
        names = listed(list(dict.fromkeys(spoken(line.other) for line in found.contacts)))
        parts.append(f"the robot touched {names}, first at {seconds(found.contacts[0].time_s)}")
    return "; ".join(parts) + "."


def headline_of_many(runs: Sequence[RunFindings]) -> str:
    """Say the same of several runs."""
    due, lost, strays, touches = (
        sum(counts)
        for counts in zip(*((r.due, len(r.lost), len(r.strays), len(r.contacts)) for r in runs), strict=True)
    )
    tracked, hidden = (sum(len(r.who_ended(how)) for r in runs) for how in (Ending.TRACKED, Ending.HIDDEN))
    passings = sum(len(r.passings) for r in runs)
    known = [change for r in runs for change in r.known_again]
    of = f"of {counted(due, 'person', 'people')} {tracked} tracked to the end"
    parts = [
        *(
            [f"a number went to somebody else {times(passings)}, {_where(runs, 'passings')}"]
            if passings
            else []
        ),
        of + (f", {hidden} hidden until the end" if hidden else ""),
        f"identity lost {times(lost)}, {_where(runs, 'lost')}" if lost else _none_lost(passings),
        *([_known_again(known)] if known else []),
        f"{counted(strays, 'track')} on nobody",
        *([f"{counted(touches, 'contact')} of the robot"] if touches else []),
    ]
    return f"{counted(len(runs), 'run')}: {'; '.join(part for part in parts if part)}."


def _where(runs: Sequence[RunFindings], what: str) -> str:
    return f"in {counted(sum(bool(getattr(run, what)) for run in runs), 'run')}"


def _passings(passings: Sequence[Passing]) -> str:
    first, count = passings[0], len(passings)
    to = f"from {spoken(first.from_person)} to {spoken(first.to_person)} at {seconds(first.time_s)}"
    if count == 1:
        return f"Number {first.number} went {to}, when {spoken(first.from_person)} {first.why}"
    return f"A number went to somebody else {times(count)}, first number {first.number} {to}"


def _known_again(changes: Sequence[Change]) -> str:
    longest = seconds(max(change.known_after_s for change in changes))
    return f"{times(len(changes))} somebody was known again after at most {longest} under another number"


def _people(found: RunFindings) -> str:
    due, hidden = found.due, found.who_ended(Ending.HIDDEN)
    others = found.who_ended(Ending.LOST, Ending.HIDDEN)
    tracked = due - len(others)
    asides = [f"{listed(hidden)} hidden until the end"] if hidden and due > 1 else []
    never = len(found.people) - due
    nearest_m, farthest_m = found.counted_m
    asides += [f"{never} more never came within {nearest_m:g} to {farthest_m:g} m in sight"] if never else []
    aside = f" ({'; '.join(asides)})" if asides else ""
    if due == 1:
        how = "hidden until" if hidden else "tracked to" if tracked else "not tracked to"
        return f"1 person, {how} the end{aside}"
    which = {0: "none", due: "both" if due == 2 else "all"}.get(tracked, f"all but {listed(others)}")
    return f"{due} people, {which} tracked to the end{aside}"


def _identities(found: RunFindings) -> list[str]:
    if not found.lost:
        none = _none_lost(len(found.passings))
        return [none] if none else []
    first = found.lost[0]
    when = f"at {seconds(first.time_s)}, when {spoken(first.person)} {first.why}"
    count = len(found.lost)
    return [f"identity lost once, {when}" if count == 1 else f"identity lost {times(count)}, first {when}"]


def _none_lost(passings: int) -> str:
    """Say that all kept their identity, if they did."""
    return "" if passings else "no identity lost"
