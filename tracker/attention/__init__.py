"""Where to look: what a person looks like, learned from one box, and where in an image that is."""
