"""Short runs give the same bytes as when these hashes were written.

The hashes are those of two seconds of each scenario. A hash may change with the version of a package
that the output depends on, with the processor, and with a change of PeopleBoy that is meant to change
the output and is in the changelog. With other packages or another processor the test is skipped.
Anything else that changes a hash is a fault.
"""

from __future__ import annotations

from hashlib import sha256
from pathlib import Path

import pytest
from llvmlite import binding

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.run_folder.folder import versions
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions

MADE_WITH = {
    "numpy": "2.4.6",
    "numba": "0.68.1",
    "opencv-python-headless": "4.14.0.94",
    "pybullet": "3.2.7",
    "scipy": "1.17.1",
}
PROCESSOR = "znver5"
HASHES = {
    ("crossing_3", "contour"): "dcaf6247e871935960f88895949bc920",
    ("crossing_2", "detection"): "b8f52b2c5131bf51218e186cbbac7ca8",
    ("single_follow", "truth"): "65cefeb24b88786a3433468e369ab852",
}


def hash_of(folder: Path) -> str:
    """Hash truth, tracks and all images of a run."""
    digest = sha256()
    files = [folder / "truth" / "gt.txt", folder / "tracks.txt", *sorted(folder.glob("*/*.png"))]
    for path in files:
        digest.update(path.relative_to(folder).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:32]


@pytest.mark.slow
@pytest.mark.parametrize(("scenario", "tracker"), HASHES)
def test_a_short_run_has_the_bytes_that_it_had(scenario: str, tracker: str, tmp_path: Path) -> None:
    installed = {name: number for name, number in versions().items() if name != "peopleboy"}
    if installed != MADE_WITH or binding.get_host_cpu_name() != PROCESSOR:
        pytest.skip(f"made with {MADE_WITH} on {PROCESSOR}")
    out = tmp_path / "run"
    options = RunOptions(seed=1, out=out, tracker=tracker, frames=True, record=False)
    run(load_scenario(scenario).lasting(2.0), options)
    assert hash_of(out) == HASHES[scenario, tracker]
