"""Who is in front of whom, as learned from examples."""
