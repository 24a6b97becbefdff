"""Store results of finished tasks, one JSON line each, from which a killed command resumes."""

import json
import os
from collections.abc import Iterator, Mapping
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, Final

from peopleboy import sim, tracker
from peopleboy.scenarios.run_folder.atomic_output import writing_to
from peopleboy.scenarios.run_folder.folder import versions
from peopleboy.user_files import parse_json

Result = dict[str, Any]

_NEEDED: Final = {"key", "code", "result"}


class Store(Mapping[str, Result]):
    """Results by key, written to disk as soon as they are added.

    Lines cut off by a kill, and results of other versions of the code, are ignored.
    """

    def __init__(self, path: Path, code: str) -> None:
        """Open the file, or create it.

        Args:
            path: path of the file.
            code: hash of the code that results depend on.

        Raises:
            BadInput: the file's folder cannot be written to.
        """
        self.path = path
        self._code = code
        self._results: dict[str, Result] = {}
        self._spent_s: dict[str, float] = {}
        with writing_to(path.parent):
            path.parent.mkdir(parents=True, exist_ok=True)
            text = path.read_text(encoding="utf-8") if path.is_file() else ""
        for line in text.splitlines():
            self._take(line)
        self._is_torn = bool(text) and not text.endswith("\n")

    def __getitem__(self, key: str) -> Result:
        return self._results[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._results)

    def __len__(self) -> int:
        return len(self._results)

    def spent_s(self, key: str) -> float:
        """Return the processor time [s] that a result took; 0 if unknown."""
        return self._spent_s.get(key, 0.0)

    def add(self, key: str, result: Result, spent_s: float = 0.0) -> None:
        """Store a result, and the processor time [s] that it took; it is on disk when this returns."""
        entry: dict[str, Any] = {
            "key": key,
            "code": self._code,
            "spent_s": round(spent_s, 3),
            "result": result,
        }
        line = json.dumps(entry) + "\n"
        with self.path.open("a", encoding="utf-8") as file:
            file.write("\n" + line if self._is_torn else line)
            file.flush()
            os.fsync(file.fileno())
        self._is_torn = False
        self._results[key], self._spent_s[key] = result, entry["spent_s"]

    def _take(self, line: str) -> None:
        try:
            entry = parse_json(line)
        except ValueError:
            return
        if isinstance(entry, dict) and entry.keys() >= _NEEDED and entry["code"] == self._code:
            self._results[entry["key"]] = entry["result"]
            self._spent_s[entry["key"]] = entry.get("spent_s", 0.0)


@cache
def code_digest(*further: Path) -> str:
    """Hash what results depend on: trackers, simulator, packages, and the given files."""
    digest = sha256(json.dumps(versions(), sort_keys=True).encode())
    roots = [Path(tracker.__path__[0]), Path(sim.__path__[0])]
    files = [path for root in roots for path in root.rglob("*") if path.suffix in (".py", ".yaml")]
    for path in sorted([*files, *further]):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]
