"""A follower that evolution improved: numpy alone learns, and the weights are in the repository."""
