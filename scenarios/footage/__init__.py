"""Tracking in footage that others recorded, and what is left of it."""
