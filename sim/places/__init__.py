"""What stands still: rooms, corridors, and the warm and cold things in them."""
