"""Batches: sweeps of many games over the factors of a design, played by any number of worker processes."""
