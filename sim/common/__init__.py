"""Shared ground of the world and a robot's software: geometry, grids, rays, and sensor messages."""
