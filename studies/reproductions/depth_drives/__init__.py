"""Drives with a depth camera, and how well people are tracked on them."""
