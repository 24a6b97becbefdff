"""Corridors: localisation by sonar or image, and corridor following."""
