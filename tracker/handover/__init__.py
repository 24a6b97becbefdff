"""One identity from the thermal image through the panorama and back."""
