"""The one error that a user's mistake raises, in every room of the project."""

import re
from collections.abc import Iterator
from contextlib import contextmanager

_LONGEST_KEY = 40  # letters shown of a key
_LONGEST_WORD = re.compile(r"\S{300,}")
_LONGEST = 500  # letters of a line
_START, _END = 300, 150  # letters shown of a longer line
_WORD_START, _WORD_END = 100, 50  # letters shown of a longer word

Key = tuple[str | int, ...]
"""Steps from the top of a file to a value in it, such as ("people", 0, "path", 1, "at_m")."""


class BadInput(ValueError):  # noqa: N818
    """Invalid input by the user: a file, flag, image or action that cannot be used.

    The message is one line that states the location, the error, the invalid value, and what would be valid.
    The command line prints this line and exits with code 2.

    Attributes:
        reason: the error, and what would be valid.
        file: the file that contains the error, as the user refers to it; empty for none.
        key: the key of the invalid value; empty for the whole file.
    """

    def __init__(self, reason: str, *, file: str = "", key: Key = ()) -> None:
        super().__init__(reason)
        self.reason, self.file, self.key = reason, file, key

    def __str__(self) -> str:
        """Return one line with file, key and reason."""
        whole = ": ".join(part for part in (self.file, dotted(self.key), self.reason) if part)
        return _LONGEST_WORD.sub(lambda word: f"{word[0][:_WORD_START]}...{word[0][-_WORD_END:]}", whole)

    def within(self, *steps: str | int, file: str = "") -> "BadInput":
        """Return the same error with a longer key, whose first steps are these.

        If the error already names a file, the whole error becomes the reason, and `file` is the new file.
        """
        if self.file:
            return BadInput(str(self), file=file, key=steps)
        return BadInput(self.reason, file=file, key=(*steps, *self.key))


def dotted(key: Key) -> str:
    """Write a key as people[0].path[1].at_m."""
    names = (step if len(str(step)) <= _LONGEST_KEY else f"{str(step)[:_LONGEST_KEY]}..." for step in key)
    text = "".join(f"[{name}]" if isinstance(name, int) else f".{name}" for name in names)
    return text.removeprefix(".")


def shortened(line: str) -> str:
    """Return a line, a long one without its middle: its start says where, its end what would be right."""
    return line if len(line) < _LONGEST else f"{line[:_START]} ... {line[-_END:]}"


@contextmanager
def found_in(*steps: str | int, file: str = "") -> Iterator[None]:
    """Return for a mistake in the block below which steps of a file it is.

    Raises:
        BadInput: that mistake.
    """
    try:
        yield
    except BadInput as error:
        raise error.within(*steps, file=file) from error
