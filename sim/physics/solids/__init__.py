"""What is solid: where it is, and where rays meet it."""
