"""What rerun shows cannot be looked at here; that it is served, to whom, and that it ends, can."""

import os
import subprocess
import sys
from pathlib import Path
from urllib.error import URLError
from urllib.request import urlopen

import pytest

CODE = """
import gymnasium, peopleboy
env = gymnasium.make("peopleboy/PersonFollowing-v0", observation="truth", render_mode="human",
                     physics="kinematic", image_size=(64, 48), scenario="crossing_2")
env.reset(seed=0)
for _ in range(3):
    env.step([0.1, 0.0])
assert env.render() is None
env.reset(seed=1)
assert env.unwrapped._viewer._time_s == 0.2
env.close()
env.close()
env.reset()  # and leave
"""


@pytest.mark.thorough
def test_without_a_screen_a_page_of_this_machine_shows_it_until_it_is_closed_or_left(tmp_path: Path) -> None:
    environment = {name: value for name, value in os.environ.items() if "DISPLAY" not in name}
    shown = subprocess.run(
        [sys.executable, "-W", "error", "-c", CODE],
        cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=240,
    )  # fmt: skip
    assert shown.returncode == 0, shown.stderr
    lines = shown.stdout.splitlines()
    assert len(lines) == 2
    for line in lines:
        words, _, address = line.rpartition(" ")
        assert address.startswith("http://127.0.0.1:")
        assert words == "Live view:"
        with pytest.raises(URLError):
            urlopen(address, timeout=5)
