"""A person's outline of two ellipses, and how well it fits the image."""
