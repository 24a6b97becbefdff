import importlib.util
import os
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from peopleboy.scenarios.cli import main
from tests.helpers.pages import DOCS, Block, blocks

PAGES = sorted([*DOCS.glob("tutorial/*.md"), *DOCS.glob("guides/*.md")])


@pytest.mark.pages
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_what_a_reader_pastes_works(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    names: dict[str, Any] = {"__name__": "tutorial"}
    for block in blocks(page):
        if not block.needs or importlib.util.find_spec(block.needs):
            do(block, names)


def do(block: Block, names: dict[str, Any]) -> None:
    """Save a block with a title; run any other one; the Python of a page shares its names."""
    if block.title:
        Path(block.title).write_text(block.code, encoding="utf-8")
    elif block.language == "python":
        exec(compile(block.code, block.where, "exec"), names)
    else:
        for line in block.code.splitlines():
            run_line(line, block.where)


def run_line(line: str, where: str) -> None:
    """Run a line of shell; `peopleboy` in this process, which saves its start."""
    words = shlex.split(line, comments=True)
    if words and words[0] == "peopleboy" and not {"|", ">"} & set(words):
        with pytest.raises(SystemExit) as left:
            main(words[1:])
        assert left.value.code == 0, f"{where}: {line}"
    else:
        path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
        subprocess.run(["bash", "-euc", line], check=True, env=os.environ | {"PATH": path})
