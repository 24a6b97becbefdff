"""Pictures of the README, the home page and the gallery."""
