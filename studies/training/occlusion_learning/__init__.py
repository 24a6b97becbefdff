"""Learning from runs who of two people is in front."""
