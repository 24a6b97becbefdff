"""Inference of the small learned networks, and the archive in which their weights are kept."""
