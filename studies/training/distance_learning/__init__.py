"""Learning from runs how far away a person is in the panorama."""
