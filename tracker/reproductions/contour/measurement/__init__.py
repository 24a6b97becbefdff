"""Measurement model: contours of two ellipses, and their fit to the image."""
