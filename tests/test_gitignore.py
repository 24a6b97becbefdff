import shutil
import subprocess
from pathlib import Path

import pytest

HOME = Path(__file__).parents[1]
WRITTEN_BY_DEFAULT = (
    "runs/pass_behind-0/run.json",
    "sets/pass_behind/README.md",
    "report.html",
    "pass_behind-plan.png",
)


def git(*arguments: str) -> str:
    if shutil.which("git") is None or not (HOME / ".git").exists():
        pytest.skip("this is no clone")
    done = subprocess.run(["git", "-C", str(HOME), *arguments], capture_output=True, text=True, check=False)
    return done.stdout


def test_what_commands_write_by_default_is_no_part_of_the_repository() -> None:
    assert git("check-ignore", "--no-index", *WRITTEN_BY_DEFAULT).split() == list(WRITTEN_BY_DEFAULT)


def test_no_file_of_the_repository_is_ignored() -> None:
    assert git("ls-files", "--cached", "--ignored", "--exclude-standard") == ""
