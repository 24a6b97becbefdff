"""Particles: motion, prior, resampling."""
