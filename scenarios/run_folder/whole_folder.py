"""A folder that says what it is, and is there whole or not at all."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from peopleboy.scenarios.run_folder.out_folder import check_out, writing_to
from peopleboy.scenarios.run_folder.whole import whole


@contextmanager
def whole_folder(
    path: Path, about: dict[str, Any], *, overwrite: bool, kind: str = "export"
) -> Iterator[Path]:
    """Give a folder to write to, which takes its place when the block ends well, see `whole`.

    A file KIND.json says what the folder is.

    Args:
        path: the folder asked for.
        about: what that file is to say; it may grow inside the block.
        overwrite: whether an earlier folder of this kind there may be replaced.
        kind: what the folder is, "export" or "run".

    Raises:
        BadInput: there is something at this path that must not be replaced, or it cannot be written to.
    """
    with writing_to(path):
        check_out(path, kind, overwrite=overwrite)
        with whole(path) as part:
            part.mkdir(parents=True)
            yield part
            (part / f"{kind}.json").write_text(json.dumps(about, indent=2) + "\n", encoding="utf-8")
