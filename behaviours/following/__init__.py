"""Person following: identity, predicted position, and approach of the person."""
