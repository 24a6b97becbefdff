"""Drawn people, corridors and footage, and what tracks say of them."""
