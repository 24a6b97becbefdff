"""Inference of the small learned networks, and the archive of their weights."""
