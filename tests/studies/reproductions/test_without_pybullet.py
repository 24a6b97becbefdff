import subprocess
import sys

import pytest

CATALOGUE = "peopleboy.studies.reproductions.experiments.catalogue"
WITHOUT = f"import sys; sys.modules['pybullet'] = None; import {CATALOGUE}"


@pytest.mark.thorough
def test_what_there_is_to_reproduce_is_listed_without_pybullet():
    done = subprocess.run([sys.executable, "-c", WITHOUT], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
