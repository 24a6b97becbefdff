"""What the sonars say: echoes as points, their memory, their failure."""
