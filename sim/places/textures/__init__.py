"""Surface textures for `detail: full`: structure in thermal images, and sunlight."""
