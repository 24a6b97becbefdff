"""Pictures of random and detailed worlds."""
