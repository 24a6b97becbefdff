"""Tracking quality in footage of unknown temperatures: real clips, and scenes of the library."""
