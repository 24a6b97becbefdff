"""Files of tests handed to workers from both ends of the list."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import pytest
from xdist.scheduler import LoadFileScheduling
from xdist.workermanage import WorkerController

_COMPILE_MOST: Final = ("benchmarks",)
_COMPILE_NOTHING: Final = ("studies/reproductions", "docs", "test_", "tracker/evaluation")


def from_both_ends(file: Path) -> int:
    """Give the order in which files are tested: first who compile most kernels, last who compile none."""
    here = file.relative_to(Path(__file__).parents[1]).as_posix()
    return here.startswith(_COMPILE_NOTHING) - here.startswith(_COMPILE_MOST)


class FromBothEnds(LoadFileScheduling):
    """Hands out files in their order, to every other worker from the last one on.

    Workers that begin alike would all compile the simulator's kernels, each for itself; one that begins with
    what needs none finds them in numba's cache when it gets there.
    """

    def __init__(self, config: pytest.Config, log: object = None) -> None:
        super().__init__(config, log)
        config.option.loadscopereorder = False

    def _assign_work_unit(self, node: WorkerController) -> None:
        if self.nodes.index(node) % 2:
            self.workqueue.move_to_end(next(reversed(self.workqueue)), last=False)
        super()._assign_work_unit(node)
