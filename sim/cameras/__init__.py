"""The cameras: their settings, and image formation from what a pixel sees to thermal and colour images."""
