"""Trackers of people in images, and their evaluation."""
