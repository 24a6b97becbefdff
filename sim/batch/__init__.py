"""Many kinematic worlds at once: their state lies side by side in arrays, which kernels go through."""
