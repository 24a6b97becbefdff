"""The one error that a user's mistake raises, in every room of the project."""

import re
from collections.abc import Iterator, Sequence
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
    The command line prints this line and exits with code 2. Several faults that were found together have a
    line each.

    Attributes:
        reason: the error, and what would be valid.
        file: the file that contains the error, as the user refers to it; empty for none.
        key: the key of the invalid value; empty for the whole file.
        others: further faults that were found with this one.
    """

    def __init__(
        self, reason: str, *, file: str = "", key: Key = (), others: Sequence["BadInput"] = ()
    ) -> None:
        super().__init__(reason)
        self.reason, self.file, self.key, self.others = reason, file, key, tuple(others)

    def __str__(self) -> str:
        """Return one line with file, key and reason for each fault."""
        return "\n".join(self.lines)

    @property
    def lines(self) -> list[str]:
        """A line for each fault."""
        return [self._line, *(line for other in self.others for line in other.lines)]

    @property
    def keys(self) -> list[Key]:
        """The key of each fault."""
        return [self.key, *(key for other in self.others for key in other.keys)]

    @property
    def _line(self) -> str:
        whole = ": ".join(part for part in (self.file, dotted(self.key), self.reason) if part)
        return _LONGEST_WORD.sub(lambda word: f"{word[0][:_WORD_START]}...{word[0][-_WORD_END:]}", whole)

    def within(self, *steps: str | int, file: str = "") -> "BadInput":
        """Return the same error with a longer key, whose first steps are these.

        If the error already names a file, the whole error becomes the reason, and `file` is the new file.
        """
        others = [other.within(*steps, file=file) for other in self.others]
        if self.file:
            return BadInput(self._line, file=file, key=steps, others=others)
        return BadInput(self.reason, file=file, key=(*steps, *self.key), others=others)


def gathered(faults: Sequence[BadInput]) -> BadInput:
    """Return one error for at least one fault."""
    first, *others = faults
    return BadInput(first.reason, file=first.file, key=first.key, others=[*first.others, *others])


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
