"""Geometry that every room may import: planar poses."""
