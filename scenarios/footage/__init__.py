"""Tracking in footage that others recorded: reading it, its grey, its truth, and what is left of it."""
