"""Who does the work: processes of this machine, or a cluster."""

from __future__ import annotations

from dataclasses import dataclass

import joblib

from peopleboy.bad_input import BadInput


@dataclass(frozen=True, slots=True)
class Workers:
    """Who does the work.

    Attributes:
        count: processes of this machine; with one, everything is done in the process that asks for it.
        scheduler: address of a Dask scheduler whose workers do it instead; None for this machine.
    """

    count: int = 1
    scheduler: str | None = None


def chosen_workers(count: int | None, scheduler: str | None) -> Workers:
    """Take what the user gave; without it, one process a core.

    Raises:
        BadInput: both are given.
    """
    if scheduler is not None and count is not None:
        raise BadInput(f"--workers {count}: the cluster of --scheduler has workers of its own; leave one out")
    return Workers(joblib.cpu_count() if count is None else count, scheduler)
