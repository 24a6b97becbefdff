"""The movement of people over the floor: paths, scripts, and giving way."""
