"""Upright rectangles on the floor: what they share, and what one leaves of another."""

from __future__ import annotations

from dataclasses import dataclass

CLOSE_M = 1e-9  # rectangles so close touch


@dataclass(frozen=True, slots=True)
class Rectangle:
    """An upright rectangle on the floor [m], world frame."""

    min_x: float
    min_y: float
    max_x: float
    max_y: float

    @property
    def is_empty(self) -> bool:
        """Whether it has no inside."""
        return self.max_x - self.min_x <= CLOSE_M or self.max_y - self.min_y <= CLOSE_M

    @property
    def centre(self) -> tuple[float, float]:
        """Its middle (x, y) [m]."""
        return (self.min_x + self.max_x) / 2.0, (self.min_y + self.max_y) / 2.0

    @property
    def longer_side(self) -> float:
        """Length of its longer side [m]."""
        return max(self.max_x - self.min_x, self.max_y - self.min_y)

    @property
    def area(self) -> float:
        """What it covers [m2]."""
        return (self.max_x - self.min_x) * (self.max_y - self.min_y)

    def grown(self, margin_m: float) -> Rectangle:
        """The rectangle with every side moved outward by margin_m; inward if it is negative."""
        return Rectangle(
            self.min_x - margin_m, self.min_y - margin_m, self.max_x + margin_m, self.max_y + margin_m
        )

    def meets(self, other: Rectangle) -> bool:
        """Whether the insides of the two share a point."""
        return not self.cut(other).is_empty

    def cut(self, other: Rectangle) -> Rectangle:
        """What the two share; empty if nothing."""
        return Rectangle(
            max(self.min_x, other.min_x),
            max(self.min_y, other.min_y),
            min(self.max_x, other.max_x),
            min(self.max_y, other.max_y),
        )

    def without(self, hole: Rectangle) -> tuple[Rectangle, ...]:
        """Split what is left outside a hole into at most four rectangles that do not overlap."""
        cut = self.cut(hole)
        if cut.is_empty:
            return (self,)
        pieces = (
            Rectangle(self.min_x, self.min_y, cut.min_x, self.max_y),
            Rectangle(cut.max_x, self.min_y, self.max_x, self.max_y),
            Rectangle(cut.min_x, self.min_y, cut.max_x, cut.min_y),
            Rectangle(cut.min_x, cut.max_y, cut.max_x, self.max_y),
        )
        return tuple(piece for piece in pieces if not piece.is_empty)

    def contains(self, x: float, y: float) -> bool:
        """Whether a point lies inside or on the edge."""
        return self.min_x <= x <= self.max_x and self.min_y <= y <= self.max_y


def subtract(block: Rectangle, holes: tuple[Rectangle, ...]) -> tuple[Rectangle, ...]:
    """Cut all holes out of a rectangle; the pieces do not overlap."""
    pieces: tuple[Rectangle, ...] = (block,)
    for hole in holes:
        pieces = tuple(rest for piece in pieces for rest in piece.without(hole))
    return pieces


def lengthened(block: Rectangle, piece: Rectangle) -> Rectangle | None:
    """The union of two rectangles that do not overlap, if it is a rectangle itself."""
    union = Rectangle(
        min(block.min_x, piece.min_x),
        min(block.min_y, piece.min_y),
        max(block.max_x, piece.max_x),
        max(block.max_y, piece.max_y),
    )
    return union if abs(union.area - block.area - piece.area) < CLOSE_M else None
