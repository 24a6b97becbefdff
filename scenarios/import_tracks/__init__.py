"""Tracks made elsewhere, put into the folder of a run of their own."""
