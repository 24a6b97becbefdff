"""Trackers for 360-degree panoramic cameras."""
