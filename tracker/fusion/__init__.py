"""Fusion of thermal, depth and colour: one track for each person."""
