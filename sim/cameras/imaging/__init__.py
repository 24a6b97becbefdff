"""Image formation: blur, light, materials, noise, and the electronics behind a detector."""
