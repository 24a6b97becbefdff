"""A robot controller that is trained with PPO; the weights of two are in the repository."""
