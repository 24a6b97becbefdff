"""Recordings and runs played through trackers and models, and scored against the truth."""
