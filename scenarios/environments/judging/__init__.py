"""What controllers earn, and how their episodes went."""
