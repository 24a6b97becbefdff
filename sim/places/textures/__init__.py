"""What `detail: full` gives to the surfaces of a place: structure that a thermal camera sees, and sun."""
