"""Walking people: who they are, when they are where, and their bodies in the physics world."""
