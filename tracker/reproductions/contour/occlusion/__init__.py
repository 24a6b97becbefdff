"""Depth order of people, by feet, by appearance or as learned, and coasting of the occluded."""
