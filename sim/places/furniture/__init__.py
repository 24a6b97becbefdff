"""Furniture and other things: builders of each kind, and the placement of a scenario's things."""
