"""What the page says of a run: how much was done, with what, and how long it took."""

from __future__ import annotations

import os
import platform
from collections.abc import Sequence, Set

from peopleboy.scenarios.run_folder.folder import versions
from peopleboy.scenarios.running.engine.store import Store
from peopleboy.studies.reproductions.experiments.catalogue import paper_of
from peopleboy.studies.reproductions.experiments.experiment import Outcome
from peopleboy.studies.reproductions.experiments.tracking import Tracking
from peopleboy.studies.reproductions.measuring.workload import QUICK_S, Plan, full_plan
from peopleboy.studies.reproductions.showing.source_page import PageHead


def head_of(
    plan: Plan, outcomes: Sequence[Outcome], store: Store, *, command: str, missing: Sequence[str]
) -> PageHead:
    """Say what there is.

    Args:
        plan: how much was wanted.
        outcomes: what is finished.
        store: with all results.
        command: by which the user began it.
        missing: ids of what is not finished.
    """
    papers = {paper_of(one.experiment.id) for one in outcomes}
    counts = {one.repeats for one in outcomes if isinstance(one.experiment, Tracking)}
    repeats = {count for count in counts if count is not None} or {plan.repeats}
    spent = sum(store.spent_s(key) for key in store)
    facts = {
        "Versions": ", ".join(f"{name} {number}" for name, number in versions().items()),
        "Python": platform.python_version(),
        "Seeds": _seeds(plan, papers, max(repeats)),
        "Machine": f"{os.cpu_count()} cores, {platform.machine()}, {platform.system()}",
        "Time": f"{spent / 3600:.2f} core-hours for all results, those of earlier calls included",
        "Results": f"{len(store)} units of work in {store.path.name}",
    }
    if missing:
        facts["Not finished"] = ", ".join(missing)
    return PageHead(
        command=command, is_quick=plan.is_quick, amount=_amount(plan, papers, repeats), facts=facts
    )


def _seeds(plan: Plan, papers: Set[str], repeats: int) -> str:
    streams = f"random streams of the trackers 0 to {repeats - 1}; data sets as in their files"
    if papers <= {"thesis", "2005"}:
        return streams
    return (
        f"{streams}; webcams 0 to {plan.repeats - 1}; people before a panoramic camera 0 to "
        f"{plan.walks - 1}; drives with a depth camera 0 to {plan.drives - 1}"
    )


def _share(plan: Plan) -> str:
    """Say how much of the data sets a quick run sees."""
    seen, there = (
        sum(play.scenario.duration_s for plays in suites.values() for play in plays)
        for suites in (plan.suites, full_plan(plan.cache).suites)
    )
    return f"{seen:.0f} of {there:.0f} s"


def _amount(plan: Plan, papers: Set[str], repeats: Set[int]) -> str:
    runs = {name: len(plays) for name, plays in plan.suites.items()}
    if plan.is_quick:
        return (
            f"One run per data set and of it {QUICK_S:g} s at most ({_share(plan)}), {plan.repeats} repeats "
            "instead of 10, fewer values of each parameter (each section says which are left out), "
            "figure 6.6 with 200 samples instead of 1000, pairs of people "
            f"from one run per scenario, no weighted triplets, {plan.walks} panoramic films of each room, "
            f"{plan.drive_s:g} s of {len(plan.sets)} of the 12 drives with a depth camera, "
            f"{len(plan.scenes)} of the 17 films of things that are moved."
        )
    if papers == {"panoramic"}:
        return f"{plan.walks} films of each room, and {plan.repeats} by webcams."
    if papers == {"situation"}:
        return (
            f"{plan.drives} runs of each of {len(plan.sets)} drives, {plan.ablated} where trackers differ in "
            f"one thing or the noise is varied, {2 * plan.drives} where odometry is left out; "
            f"{plan.scene_seeds} of each of {len(plan.scenes)} films of moved things, by {len(plan.presets)} "
            f"depth cameras. {plan.drives} runs of each film of attention, {plan.absences} of each absence, "
            f"{plan.follows} of followers."
        )
    total = ", ".join(f"{name}: {count} runs" for name, count in runs.items())
    count = (
        f"{max(repeats)}" if len(repeats) == 1 else f"{min(repeats)} to {max(repeats)}, as each part says,"
    )
    return f"{count} repeats of everything with other random numbers in the trackers. {total}."
