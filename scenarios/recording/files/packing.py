"""A finished recording, written anew in fewer pieces."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from peopleboy.scenarios.run_folder.whole import whole

_ONLY_ERRORS = {"RUST_LOG": "error"}


def pack(path: Path) -> None:
    """Join the pieces of a recording, as they came second by second, which takes a sixth off its size.

    There is always a complete file: the new one takes its place at the end, or not at all if rerun's program
    fails.
    """
    # Rerun's program takes it for no failure if it can make nothing of its input, and then leaves nothing.
    with whole(path) as packed:
        command = [sys.executable, "-m", "rerun_cli", "rrd", "optimize", str(path), "--output", str(packed)]
        done = subprocess.run(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            env=os.environ | _ONLY_ERRORS, check=False,
        )  # fmt: skip
        if done.returncode != 0:
            packed.unlink(missing_ok=True)
