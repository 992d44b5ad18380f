"""Sweeps: many games over the factors of a design, played by several worker processes."""
