"""Walking people: their settings, their movement, and their bodies in the physics world."""
