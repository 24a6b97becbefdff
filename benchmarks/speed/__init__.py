"""Measurements of `make bench`: parts of a frame and the whole loop, compared with a peer in the same run."""
