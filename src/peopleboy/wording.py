"""Counts in words, as every room's messages want them."""


def counted(count: int, one: str, several: str = "") -> str:
    """Say how many, such as "1 frame", "2 frames", "3 people"."""
    return f"{count} {one if count == 1 else several or one + 's'}"
