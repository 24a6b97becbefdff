"""Processes for tests to interrupt."""

from __future__ import annotations

import signal
import subprocess
from collections.abc import Sequence
from typing import Any


def start(command: Sequence[str], **options: Any) -> subprocess.Popen[str]:
    """Start a process that hears Ctrl-C, also where the tests themselves run in a shell's background."""
    return subprocess.Popen(command, text=True, preexec_fn=_hear, **options)


def _hear() -> None:
    signal.signal(signal.SIGINT, signal.SIG_DFL)
