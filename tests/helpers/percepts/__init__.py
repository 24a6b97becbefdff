"""What a behaviour is told, and a flat world to drive in."""
