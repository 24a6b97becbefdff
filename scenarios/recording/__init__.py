"""Rerun recordings of runs, and rerun's viewer; no other package imports rerun."""
