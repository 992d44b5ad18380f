"""Numerics that are the same on every machine: elementary functions, matrices, keyed noise, and compiled kernels."""
