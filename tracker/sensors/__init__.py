"""Sensors of the people tracker: they turn frames into detections."""
