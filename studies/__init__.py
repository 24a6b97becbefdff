"""Studies: the sources measured again, and learning who is in front."""
