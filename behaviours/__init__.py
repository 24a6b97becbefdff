"""Tracks and sonar in, velocity command out."""
