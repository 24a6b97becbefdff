"""What full detail adds to images, on and off side by side."""
