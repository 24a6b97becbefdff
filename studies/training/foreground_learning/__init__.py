"""Learning from rendered scenes which pixels of the panorama are people."""
