"""Shapes and their materials, and the table of all shapes of a world."""
