"""A follower trained by an evolution strategy in NumPy; the weights are in the repository."""
