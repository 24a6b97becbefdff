"""Scene models compared on films in which things are moved: what they take to stand, and what they tell."""
