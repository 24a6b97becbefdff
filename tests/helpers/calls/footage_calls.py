"""Calls of the command `track` as users make them."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

from click.testing import CliRunner, Result

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.footage_commands import track


def call(*arguments: Any) -> Result:
    return CliRunner().invoke(track, [str(argument) for argument in arguments])


def refusal(*arguments: Any) -> str:
    """Give the one line that a call ends with."""
    result = call(*arguments)
    assert isinstance(result.exception, BadInput), result.output
    assert "\n" not in str(result.exception)
    return str(result.exception)


def call_afresh(*arguments: Any) -> subprocess.CompletedProcess[str]:
    """Call it in a process of its own, which shows what libraries write past Python."""
    command = [sys.executable, "-m", "peopleboy", "track", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)
