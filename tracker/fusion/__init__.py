"""People by heat, depth and colour at once, each with one number."""
