"""Runs sorted as a rendered set splits them, so that no export trains on what is for tests."""

from __future__ import annotations

from collections.abc import Sequence

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.export.dataset.splits import SPLITS, read_split
from peopleboy.scenarios.run_folder.finished_run import FinishedRun


def by_split(runs: Sequence[FinishedRun]) -> dict[str | None, list[FinishedRun]]:
    """Sort runs by the splits of the rendered sets that they lie in; None alone if they lie in none.

    Raises:
        BadInput: some lie in rendered sets and some do not, or one is not in its set's splits.
    """
    found: dict[str | None, list[FinishedRun]] = {}
    for run in runs:
        found.setdefault(read_split(run.folder), []).append(run)
    if None in found and len(found) > 1:
        raise BadInput(
            f"{found[None][0].folder}: lies in no rendered set, other runs do and have splits; "
            "export them one after the other"
        )
    return {split: found[split] for split in (None, *SPLITS) if split in found}
