"""How fast things are: medians, and ratios against a named peer in the same run."""
