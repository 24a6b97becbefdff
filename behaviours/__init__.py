"""Behaviours: from tracks and sonar ranges to velocity commands."""
