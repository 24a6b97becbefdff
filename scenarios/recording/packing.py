"""A finished recording, written anew in fewer pieces."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

_ONLY_ERRORS = {"RUST_LOG": "error"}


def pack(path: Path) -> None:
    """Join the pieces of a recording, as they came second by second, which takes a sixth off its size.

    There is always a complete file: the new one takes its place at the end, or not at all if rerun's program
    fails.
    """
    packed = path.with_suffix(".packed")
    command = [sys.executable, "-m", "rerun_cli", "rrd", "optimize", str(path), "--output", str(packed)]
    done = subprocess.run(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        env=os.environ | _ONLY_ERRORS, check=False,
    )  # fmt: skip
    # Rerun's program takes it for no failure if it can make nothing of its input.
    if done.returncode == 0 and packed.is_file():
        packed.replace(path)
    packed.unlink(missing_ok=True)
