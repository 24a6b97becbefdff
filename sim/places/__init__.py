"""Places: rooms, corridors and streets, with the warm and cold things in them."""
