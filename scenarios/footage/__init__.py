"""Track people in recorded footage."""
