"""Image formation: from what a pixel sees to thermal and colour images."""
