"""How people move: gaits from motion capture, manners of moving, and stances between them."""
