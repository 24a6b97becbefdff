"""Batched simulation: the state of many kinematic worlds in joint arrays, advanced by kernels."""
