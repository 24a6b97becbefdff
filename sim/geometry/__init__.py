"""Cameras as pinholes, poses, vectors, and the map between two cameras."""
