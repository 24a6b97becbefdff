"""Files of tests handed to workers from both ends of the list."""

from __future__ import annotations

import pytest
from xdist.scheduler import LoadFileScheduling
from xdist.workermanage import WorkerController


class FromBothEnds(LoadFileScheduling):
    """Hands out files in the order of their names, to every other worker from the last one on.

    Workers that begin with the same room would all compile its kernels, each for itself; one that begins with
    the trackers finds those of the simulator in numba's cache when it gets there, and the other way round.
    """

    def __init__(self, config: pytest.Config, log: object = None) -> None:
        super().__init__(config, log)
        config.option.loadscopereorder = False

    def _assign_work_unit(self, node: WorkerController) -> None:
        if self.nodes.index(node) % 2:
            self.workqueue.move_to_end(next(reversed(self.workqueue)), last=False)
        super()._assign_work_unit(node)
